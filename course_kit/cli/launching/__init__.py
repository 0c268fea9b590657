"""Runs launch files where the real `launch` and `launch_ros` are not installed.

The modules of this package do the work. `stand_ins` has a Python launch file find them as `launch` and `launch_ros`,
for a launch only; `xml_and_yaml_actions` makes the same of XML and YAML. The order of events and the output are those
of the real ones.
"""
