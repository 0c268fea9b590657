"""Places for the boxes of a graph: layers from left to right, a band for each group, and ways that cross no box.

Nodes stand in the even columns, what they talk over in the odd ones. Lines run between columns in the gaps, and
through a column only in rows that are kept free for them, so that no line crosses a text. All lengths are inches.
"""

from __future__ import annotations

import itertools
import statistics
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from course_kit.ros.graph.layers import ROW_GAP, Box, Line, assign_layers, find_levels, natural

MAX_LEVELS = 4  # columns of nodes; a longer chain folds back
WIDE = 15.0  # where the picture would be wider, a chain folds back a column earlier
LANE_PAD, LANE_GAP, TITLE = 0.1, 0.14, 0.24
COLUMN_GAP, PER_LINE, WIDEST_GAP = 0.36, 0.02, 0.9
FREE_ROW = 0.07  # of a line that passes a column
SWEEPS = 12


@dataclass(frozen=True)
class Band:
    """The rectangle of a group."""

    group: str
    x: float
    y: float
    width: float
    height: float


@dataclass
class Layout:
    """Where everything is; the origin is the upper left corner."""

    boxes: dict[str, Box]
    lines: list[Line]
    bands: list[Band]
    width: float
    height: float


def lay_out(boxes: Iterable[Box], lines: Iterable[Line], titles: dict[str, float]) -> Layout:
    """Place boxes and lead lines. `titles` are the groups that get a band, with the widths of their titles.

    The same input gives the same layout.
    """
    there, drawn = sorted(boxes, key=lambda box: (box.group, natural(box.key))), list(lines)
    layout = _lay_out(there, drawn, titles, MAX_LEVELS)
    if layout.width > WIDE:
        layout = _lay_out(there, drawn, titles, MAX_LEVELS - 1)
    return layout


def _lay_out(boxes: list[Box], drawn: list[Line], titles: dict[str, float], max_levels: int) -> Layout:
    placed = {box.key: box for box in boxes}
    assign_layers(placed, drawn, find_levels(placed, drawn, max_levels), max_levels)
    _keep_rows_free(placed, drawn)
    last = max((box.layer for box in placed.values()), default=-1)
    columns = [[box for box in placed.values() if box.layer == layer] for layer in range(last + 1)]
    groups = sorted({box.group for box in boxes}, key=lambda group: (group in titles, natural(group)))
    neighbours = _neighbours(drawn)
    _order(columns, groups, neighbours)
    bands, height = _place_rows(placed, columns, groups, titles, neighbours)
    sides = _place_columns(placed, columns, drawn, titles)
    for line in drawn:
        line.points = _points(line, placed, sides)
    width = sides[-1][1] + LANE_PAD if sides else 0.0
    rectangles = [Band(group, 0.0, top, width, bottom - top) for group, (top, bottom) in bands.items()]
    return Layout({k: b for k, b in placed.items() if not b.is_line}, drawn, rectangles, width, height)


def _keep_rows_free(boxes: dict[str, Box], lines: list[Line]) -> None:
    """Find the way of each line; the rows in which it passes columns are boxes without width."""
    for line in lines:
        start, end = boxes[line.node].layer, boxes[line.box].layer
        step = 1 if end > start else -1
        line.way = [line.node]
        for layer in range(start + step, end, step):
            key = f"{line.box} {line.part} {line.outward} {line.bundle} {step} {layer}"
            if key not in boxes:
                boxes[key] = Box(key, boxes[line.box].group, False, 0.0, FREE_ROW, (FREE_ROW / 2,), layer)
            line.way.append(key)
        line.way.append(line.box)


Neighbours = dict[str, list[tuple[str, int]]]


def _neighbours(lines: list[Line]) -> Neighbours:
    """For each box those that a line leads to next, with the part at which it ends there."""
    found: dict[str, set[tuple[str, int]]] = defaultdict(set)
    for line in lines:
        way = [*((key, 0) for key in line.way[:-1]), (line.box, line.part)]
        for one, other in itertools.pairwise(way):
            found[one[0]].add(other)
            found[other[0]].add(one)
    return {key: sorted(others) for key, others in found.items()}


def _order(columns: list[list[Box]], groups: list[str], neighbours: Neighbours) -> None:
    """Sort each column, by groups, so that few lines cross: each box at the mean height of what it leads to."""
    rank = {group: n for n, group in enumerate(groups)}
    for column in columns:
        column.sort(key=lambda box: (rank[box.group], box.is_line, natural(box.key)))
    _stack(columns, groups)
    for sweep in range(SWEEPS):
        way = range(len(columns)) if sweep % 2 == 0 else range(len(columns) - 1, -1, -1)
        by_key = {box.key: box for column in columns for box in column}
        for n in way:
            side = None if sweep >= SWEEPS - 4 else (n - 1 if sweep % 2 == 0 else n + 1)
            wanted = {box.key: _wanted(box, by_key, neighbours, side) for box in columns[n]}
            columns[n].sort(key=lambda box: (rank[box.group], wanted[box.key]))
            _stack([columns[n]], groups)


def _wanted(box: Box, boxes: dict[str, Box], neighbours: Neighbours, side: int | None = None) -> float:
    """The height at which the middle of a box should stand; `side` leaves only the neighbours of one column."""
    near = [(boxes[key], part) for key, part in neighbours.get(box.key, ())]
    heights = [b.y + b.ports[min(part, len(b.ports) - 1)] for b, part in near if side in (None, b.layer)]
    return statistics.fmean(heights) if heights else box.y + box.height / 2


def _stack(columns: list[list[Box]], groups: list[str]) -> None:
    """First heights: each group begins where it would if all columns were equally full."""
    for column in columns:
        for n, group in enumerate(groups):
            inside = [box for box in column if box.group == group]
            full = sum(box.height + ROW_GAP for box in inside)
            y = n * 100.0 - full / 2
            for box in inside:
                box.y = y
                y += box.height + ROW_GAP


def _place_rows(
    boxes: dict[str, Box], columns: list[list[Box]], groups: list[str], titles: dict[str, float], neighbours: Neighbours
) -> tuple[dict[str, tuple[float, float]], float]:
    """Give every box its height, without overlap; return top and bottom of each band, and the height of all."""
    inner: dict[str, tuple[float, float]] = {}
    bands: dict[str, tuple[float, float]] = {}
    y = 0.0
    for group in groups:
        full = max(sum(b.height + ROW_GAP for b in column if b.group == group) - ROW_GAP for column in columns)
        title, pad = (TITLE, LANE_PAD) if group in titles else (0.0, 0.0)
        inner[group] = y + title, y + title + full
        if group in titles:
            bands[group] = y, y + title + full + pad
        y += title + full + pad + LANE_GAP
    by_group = ([b for b in column if b.group == group] for column in columns for group in groups)
    stacks = [stack for stack in by_group if stack]
    for stack in stacks:
        top, bottom = inner[stack[0].group]
        full = sum(b.height + ROW_GAP for b in stack) - ROW_GAP
        _settle(stack, [top + (bottom - top - full) / 2] * len(stack), top, bottom)
    for _ in range(SWEEPS):
        for stack in [*stacks, *stacks[::-1]]:
            wanted = [_wanted(b, boxes, neighbours) - b.ports[len(b.ports) // 2] for b in stack]
            _settle(stack, wanted, *inner[stack[0].group])
    return bands, max(y - LANE_GAP, 0.0)


def _settle(stack: list[Box], wanted: list[float], top: float, bottom: float) -> None:
    """Place a stack as near to the wanted heights as its order and the bounds allow (isotonic regression)."""
    *offsets, end = itertools.accumulate((box.height + ROW_GAP for box in stack), initial=0.0)
    blocks: list[list[float]] = []  # mean, weight, members
    for want, before, box in zip(wanted, offsets, stack, strict=True):
        weight = 4.0 if box.is_line else 1.0  # a bend in a passing line is more of a nuisance
        blocks.append([want - before, weight, 1])
        while len(blocks) > 1 and blocks[-2][0] > blocks[-1][0]:
            mean, w, count = blocks.pop()
            m0, w0, c0 = blocks[-1]
            blocks[-1] = [(m0 * w0 + mean * w) / (w0 + w), w0 + w, c0 + count]
    means = [mean for mean, _, count in blocks for _ in range(int(count))]
    highest = bottom - (end - ROW_GAP)
    for box, mean, before in zip(stack, means, offsets, strict=True):
        box.y = min(max(mean, top), highest) + before


def _place_columns(
    boxes: dict[str, Box], columns: list[list[Box]], lines: list[Line], titles: dict[str, float]
) -> list[tuple[float, float]]:
    """Left and right side of each column; the more lines cross a gap steeply, the wider it is."""
    steep: dict[int, float] = defaultdict(float)
    for line in lines:
        for one, other in itertools.pairwise(line.way):
            a, b = boxes[one], boxes[other]
            steep[min(a.layer, b.layer)] += min(abs(a.y - b.y), 1.0)
    sides: list[tuple[float, float]] = []
    x = LANE_PAD
    for n, column in enumerate(columns):
        width = max((box.width for box in column), default=0.0)
        if n == 0:
            width = max([width, *titles.values()])
        sides.append((x, x + width))
        for box in column:
            box.x = x + (width - box.width) / 2
        x += width + min(COLUMN_GAP + PER_LINE * steep[n], WIDEST_GAP)
    return sides


def _points(line: Line, boxes: dict[str, Box], sides: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """The points of a line, from its beginning to its end; every second stretch crosses a gap."""
    start, end = boxes[line.node], boxes[line.box]
    right = end.layer > start.layer
    # A line against the stream is led beside the others, so that both directions can be told apart.
    aside = 0.0 if right == line.outward else 0.07
    leave, enter = (1, 0) if right else (0, 1)
    points = [(start.x + start.width * leave, start.y + start.ports[0] + aside)]
    points.append((sides[start.layer][leave], points[0][1]))
    for key in line.way[1:-1]:
        row = boxes[key]
        y = row.y + row.ports[0]
        points += [(sides[row.layer][enter], y), (sides[row.layer][leave], y)]
    y = end.y + end.ports[line.part] + aside
    points += [(sides[end.layer][enter], y), (end.x + end.width * enter, y)]
    return points if line.outward else points[::-1]
