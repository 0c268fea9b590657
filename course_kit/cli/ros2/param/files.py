"""Parameter files: what they hold for a node, and how names with dots are written in them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from course_kit.cli.ros2.verbs import CommandError, failing, one_line, refuse_device

EVERY_NODE, PARAMETERS = "/**", "ros__parameters"  # keys of a file: who has the parameters, and where they stand
VALUES = "true or false, an integer of 64 bits, a float, a string, or a list of one of these"


def read(path: str, node: str, with_wildcard: bool) -> dict[str, Any]:
    """{name: value} of all that a parameter file holds, whichever nodes it names, as rclpy reads it.

    What stands below `node` itself counts most, what stands below /** least, or nothing if not `with_wildcard`.
    CommandError for what is no such file.
    """
    import yaml

    def say(error: Exception) -> str:
        if isinstance(error, OSError):
            return f"{error.strerror}: '{path}'"
        if isinstance(error, yaml.YAMLError):
            return f"{path} is no YAML: {one_line(error)}"
        return f"{path} is no parameter file: write '{node}: {{{PARAMETERS}: {{name: value}}}}', each value {VALUES}"

    refuse_device(path)
    with failing(Exception, say=say), open(path, encoding="utf-8") as file:  # PyYAML raises whatever a text leads to
        groups = dict(yaml.safe_load(file).items())
    if not with_wildcard:
        groups.pop(EVERY_NODE, None)
    if not groups:
        raise CommandError("Param file does not contain selected parameters")
    found: dict[str, Any] = {}
    for owner in sorted(groups, key=lambda owner: (owner == node) - (owner == EVERY_NODE)):
        if not isinstance(groups[owner], dict) or PARAMETERS not in groups[owner]:
            raise CommandError(f"YAML file is not a valid ROS parameter file for node {owner}")
        with failing(Exception, say=say):
            found |= flat(groups[owner][PARAMETERS])
    return found


def nested(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """{'a.b': 1} as {'a': {'b': 1}}: how a parameter file writes names with dots, unless there is an 'a' before."""
    tree: dict[str, Any] = {}
    for name, value in parameters.items():
        branch, rest = tree, name
        while "." in rest and isinstance(branch.setdefault(rest.split(".")[0], {}), dict):
            group, _, rest = rest.partition(".")
            branch = branch[group]
        branch[rest] = value
    return tree


def flat(tree: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """{'a': {'b': 1}} as {'a.b': 1}: what nested() makes, taken apart."""
    found: dict[str, Any] = {}
    for name, value in tree.items():
        found |= flat(value, f"{prefix}{name}.") if isinstance(value, Mapping) else {prefix + name: value}
    return found
