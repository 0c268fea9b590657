"""Places for the boxes of trees: roots at the left, children to the right of their parents. Pure, no ROS.

All lengths are inches; the origin is the upper left corner.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from course_kit.ros.graph.layers import ROW_GAP, Box, natural

COLUMN_GAP = 0.55
TREE_GAP = 0.3  # between two trees


def lay_out(
    boxes: Mapping[str, Box], children: Mapping[str, Sequence[str]], roots: Sequence[str]
) -> tuple[float, float]:
    """Place the boxes of all trees; return width and height of all. A frame is placed once, where it comes first."""
    width = y = 0.0
    placed: set[str] = set()
    for root in roots:
        x = 0.0
        for column in _columns(children, root, placed):
            for name in column:
                boxes[name].x = x
            width = max(width, x + max(boxes[name].width for name in column))
            x += max(boxes[name].width for name in column) + COLUMN_GAP
        y = _stack(root, boxes, children, placed, y) - ROW_GAP + TREE_GAP
    return width, max(y - TREE_GAP, 0.0)


def _columns(children: Mapping[str, Sequence[str]], root: str, placed: set[str]) -> list[list[str]]:
    """The frames of one tree, by how many steps they are from its root."""
    columns: list[list[str]] = []
    seen = set(placed)
    column = [root]
    while column:
        columns.append(column)
        seen.update(column)
        column = [child for name in column for child in children.get(name, ()) if child not in seen]
    return columns


def _stack(
    name: str, boxes: Mapping[str, Box], children: Mapping[str, Sequence[str]], placed: set[str], top: float
) -> float:
    """Place a frame beside the middle of its children, which stand below one another; return where the next begins."""
    placed.add(name)
    box, y = boxes[name], top
    own = [child for child in sorted(children.get(name, ()), key=natural) if child not in placed]
    for child in own:
        y = _stack(child, boxes, children, placed, y)
    if not own:
        box.y = top
        return top + box.height + ROW_GAP
    first, last = boxes[own[0]], boxes[own[-1]]
    middle = (first.y + first.ports[0] + last.y + last.ports[0]) / 2
    box.y = max(top, middle - box.ports[0])
    return max(y, box.y + box.height + ROW_GAP)
