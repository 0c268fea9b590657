"""The machine and its packages: what the course needs is checked and installed here, and workspaces are built.

It asks base, ros and robots (for tf2). Each start of Python imports it, so it loads nothing.
"""
