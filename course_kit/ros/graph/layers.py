"""The columns of a graph: nodes in the even ones, what they talk over in the odd ones, from left to right."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from dataclasses import dataclass, field

ROW_GAP = 0.11  # inches between two boxes of a column
BACKWARD = 1.6  # how much worse a line from right to left is than one column more
LONG = 4.0  # inches; columns that would be longer are relieved


@dataclass
class Box:
    """Something to be placed. `ports` are the heights, from its top, at which lines of its parts end."""

    key: str
    group: str
    is_node: bool
    width: float
    height: float
    ports: tuple[float, ...] = ()
    layer: int = 0
    x: float = 0.0  # of the left side
    y: float = 0.0  # of the top

    @property
    def is_line(self) -> bool:
        """True if it only keeps a place for a line that passes the layer."""
        return self.width == 0.0


@dataclass
class Line:
    """A line between a node and a part of something it talks over; `outward` is from the node."""

    node: str
    box: str
    part: int
    outward: bool
    bundle: str = ""  # lines of one bundle may share the rows in which they pass columns
    way: list[str] = field(default_factory=list)  # the keys of its node, of the rows kept free for it, of its box
    points: list[tuple[float, float]] = field(default_factory=list)


def natural(name: str) -> tuple[tuple[int, int, str], ...]:
    """A sort key by which node_2 comes before node_10."""
    pieces = re.findall(r"[0-9]+|[^0-9]+", name)
    return tuple((0, int(piece), "") if piece.isdecimal() else (1, 0, piece) for piece in pieces)


def find_levels(boxes: dict[str, Box], lines: list[Line], max_levels: int) -> dict[str, int]:
    """The column of nodes in which each node stands, from 0: after those that it hears, where there is no cycle."""
    after = _successors(boxes, lines)
    order = _feedback_order(after)
    rank = {node: n for n, node in enumerate(order)}
    forward = {node: {other for other in after[node] if rank[other] > rank[node]} for node in order}
    levels = dict.fromkeys(order, 0)
    for node in order:
        for other in forward[node]:
            levels[other] = max(levels[other], levels[node] + 1)
    heard = {other for others in forward.values() for other in others}
    for node in reversed(order):  # who hears nobody stands just before those that hear it
        if node not in heard and forward[node]:
            levels[node] = min(levels[other] for other in forward[node]) - 1
    while (deepest := max(levels.values(), default=0)) >= max_levels:  # fold where the fewest lines are turned back
        ahead = ((levels[node], levels[other]) for node, others in forward.items() for other in others)
        steps = Counter(level for level, of_other in ahead if of_other == level + 1)
        fold = min(range(deepest), key=steps.__getitem__)
        levels = {node: level - (level > fold) for node, level in levels.items()}
    return levels


def _successors(boxes: dict[str, Box], lines: list[Line]) -> dict[str, set[str]]:
    speakers: dict[str, set[str]] = defaultdict(set)
    listeners: dict[str, set[str]] = defaultdict(set)
    for line in lines:
        (speakers if line.outward else listeners)[line.box].add(line.node)
    after: dict[str, set[str]] = {key: set() for key, box in boxes.items() if box.is_node}
    for key in speakers:
        for speaker in speakers[key]:
            after[speaker] |= listeners[key] - {speaker}
    return after


def _feedback_order(after: dict[str, set[str]]) -> list[str]:
    """An order of the nodes in which few point backward (the heuristic of Eades, Lin and Smyth)."""
    before = {node: {other for other in after if node in after[other]} for node in after}
    left, first, last = dict.fromkeys(sorted(after)), [], []
    while left:
        if sinks := [node for node in left if not after[node] & left.keys()]:
            last += sinks
        elif sinks := [node for node in left if not before[node] & left.keys()]:
            first += sinks
        else:
            sinks = [max(left, key=lambda node: len(after[node] & left.keys()) - len(before[node] & left.keys()))]
            first += sinks
        for node in sinks:
            del left[node]
    return first + last[::-1]


def assign_layers(boxes: dict[str, Box], lines: list[Line], levels: dict[str, int], max_levels: int) -> None:
    """Columns for all: nodes by level, the others where the lines are short and run to the right."""
    for node, level in levels.items():
        boxes[node].layer = 2 * level
    of_box: dict[str, list[Line]] = defaultdict(list)
    for line in lines:
        of_box[line.box].append(line)
    last = 2 * max(levels.values(), default=0) + 1
    for key, ends in of_box.items():

        def cost(layer: int, ends: list[Line] = ends) -> float:
            runs = [(layer - boxes[e.node].layer) * (1 if e.outward else -1) for e in ends]
            return sum(abs(run) + (BACKWARD if run < 0 else 0.0) for run in runs)

        boxes[key].layer = min(range(-1, last + 1, 2), key=cost)
    _spread(boxes, of_box, max_levels)
    lowest = min((box.layer for box in boxes.values()), default=0)
    for box in boxes.values():
        box.layer -= lowest


def _spread(boxes: dict[str, Box], of_box: dict[str, list[Line]], max_levels: int) -> None:
    """Put what hangs together, and not with the rest, side by side where one column would grow long."""
    together = _components(boxes, of_box)
    filled: dict[tuple[str, int], float] = defaultdict(float)
    lengths: dict[int, float] = defaultdict(float)
    for box in boxes.values():
        lengths[box.layer] += box.height + ROW_GAP
    last = max(lengths, default=0)
    if max(lengths.values(), default=0.0) > LONG:
        last = max(last, 2 * max_levels - 3)
    for members in sorted(together, key=lambda keys: (-len(keys), natural(keys[0]))):
        right = max(boxes[key].layer for key in members)
        _, shift = min(
            (round(max(filled[boxes[k].group, boxes[k].layer + shift] for k in members), 3), shift)
            for shift in range(0, max(last - right, 0) + 1, 2)
        )
        for key in members:
            boxes[key].layer += shift
            filled[boxes[key].group, boxes[key].layer] += boxes[key].height + ROW_GAP


def _components(boxes: dict[str, Box], of_box: dict[str, list[Line]]) -> list[list[str]]:
    """The keys of what hangs together."""
    home = {key: [key] for key in boxes}
    for key, lines in of_box.items():
        for line in lines:
            one, other = home[key], home[line.node]
            if one is not other:
                one += other
                home.update(dict.fromkeys(other, one))
    return list({id(keys): sorted(keys) for keys in home.values()}.values())
