"""The exercises: a folder a chapter with its checks and solutions, the checker's half, the notebook's half, the faults.

It asks base, ros, robots, setup and lab; nothing of cli or views. A student's kernel loads none of the checker's half.
"""
