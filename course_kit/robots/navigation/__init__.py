"""A robot finds its way: a map from scans, where it is on one, a path, and how to follow it. Examples to read.

Of each step there is a pure part in numpy and a small node: grid and scan_matching (Mapper), localization (Localizer),
planning (Planner), pursuit and journey (Navigator).
"""
