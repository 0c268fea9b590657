"""Causes in ROS names: of nodes, topics, services and namespaces."""

from __future__ import annotations

import re

from course_kit.ros.causes.raised import Raised, Rule


def _allowed(name: str, others: str) -> str:
    """The name that is nearest to this one and allowed."""
    cleaned = [re.sub(rf"[^A-Za-z0-9_{others}]", "_", part).strip("_") for part in name.split("/")]
    return "/".join(f"n{part}" if part[:1].isdigit() else part for part in cleaned).rstrip("/") or "chatter"


def _of_node(raised: Raised, _: re.Match[str]) -> str:
    name = _quoted(raised)
    if "/" in name.strip("/") or name.startswith("/"):
        namespace, last = name.rsplit("/", 1)
        return (
            f"The name of a node has no / in it, its namespace goes apart: write super().__init__('{last}', "
            f"namespace='{namespace or '/'}')"
        )
    return f"The name of a node has letters, digits and _ only, no digit first: write '{_allowed(name, '')}'"


def _of_topic(raised: Raised, _: re.Match[str]) -> str:
    return (
        f"The name of a topic or service has letters, digits, _ and / only, and no part begins with a digit or is "
        f"empty: write '{_allowed(_quoted(raised), '~{}')}'"
    )


def _quoted(raised: Raised) -> str:
    found = re.search(r"'([^']*)'\s*\n\s*\^", raised.text)
    return found[1] if found else ""


RULES: tuple[Rule, ...] = (
    ("InvalidNodeNameException", r"", _of_node),
    ("InvalidTopicNameException|InvalidServiceNameException", r"", _of_topic),
    (
        "InvalidNamespaceException",
        r"",
        "A namespace begins with / and has letters, digits, _ and / only: write namespace='/robot1'",
    ),
)
