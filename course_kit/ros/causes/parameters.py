"""Causes in parameters."""

from __future__ import annotations

import re

from course_kit.ros.causes.raised import Raised, Rule

PYTHON = {"DOUBLE": "float", "INTEGER": "int", "STRING": "str", "BOOL": "bool"}


def _wrong_type(raised: Raised, found: re.Match[str]) -> str:
    name, value, given, wanted = found.groups()
    cure = f"{value}.0" if (given, wanted) == ("INTEGER", "DOUBLE") else f"a {PYTHON.get(wanted, wanted.lower())}"
    return f"The parameter {name} was declared as {wanted} and cannot become {given}: give it {cure}"


RULES: tuple[Rule, ...] = (
    (
        "ParameterNotDeclaredException",
        r"undeclared parameter\(s\)[:',\s]*(\w+)",
        r"A node declares its parameters before it uses them: write self.declare_parameter('\1', 1.0) in __init__, "
        r"with a value to start from",
    ),
    (
        "ParameterAlreadyDeclaredException",
        r"already declared: \[?'?(\w+)",
        r"The parameter \1 is declared twice, and a node allows it once: read it with self.get_parameter('\1')",
    ),
    (
        "InvalidParameterTypeException",
        r"parameter '(\w+)' to '(.*)' of type '(\w+)', expecting type '(\w+)'",
        _wrong_type,
    ),
    (
        "ParameterUninitializedException",
        r"'?(\w+)'?$",
        r"The parameter \1 was declared without a value: write self.declare_parameter('\1', 1.0)",
    ),
    (
        "TypeError",
        r"'Parameter'",
        "get_parameter() gives the parameter, and its value is in .value: write self.get_parameter('speed').value",
    ),
)
