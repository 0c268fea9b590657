"""The functions that a student's cells call: nodes in the background, recordings, bags, logs, plots.

It asks base, ros and robots.
"""
