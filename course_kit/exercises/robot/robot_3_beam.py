"""The check of robot-3: the cells of a grid that one beam of a laser passes."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

from course_kit.exercises.checker.assertions import chance, compute, expect, require
from course_kit.exercises.checker.checks import check_of

BEAMS = 60
TOUCHED = 0.2  # of a cell's side: what a beam crosses by less may be missing
CALL_TIMEOUT = 3.0
Cell = tuple[int, int]


@check_of("robot-3")
def cells_of_beam() -> None:
    """The cells that a beam passes, from the first to the last but one."""
    beams = [_beam() for _ in range(BEAMS)]
    found: list[list[Cell]] = []
    for beam in beams:
        returned = compute(*beam, timeout=CALL_TIMEOUT)
        pairs = returned if isinstance(returned, list) else None
        is_right = pairs is not None and all(_is_cell(one) for one in pairs)
        require(
            "it returns pairs of whole numbers",
            is_right,
            f"For {_written(beam)} it returned {str(returned)[:200]}. A list of (row, column), each an int: "
            "`math.floor(y / resolution)` is one, `y // resolution` is a float.",
        )
        found.append([(int(row), int(column)) for row, column in pairs or []])
    twice = [n for n, cells in enumerate(found) if len(set(cells)) < len(cells)]
    expect(
        "each cell is there once",
        not twice and any(found),
        f"For {_written(beams[twice[0] if twice else 0])} a cell is there twice, or there is none at all: points that "
        "are nearer to each other than cells fall into the same ones.",
    )
    lengths = [_crossed(*beam) for beam in beams]
    ends = [_cell_at(*beam) for beam in beams]
    missing = [
        {cell for cell, length in crossed.items() if length > TOUCHED * beam[4] and cell != end} - set(cells)
        for beam, crossed, end, cells in zip(beams, lengths, ends, found, strict=True)
    ]
    number = max(range(BEAMS), key=lambda n: len(missing[n]))
    expect(
        "none that the beam passes is missing",
        not any(missing),
        f"For {_written(beams[number])} {len(missing[number])} cells are missing, such as "
        f"{min(missing[number], default=None)}. {_beam_cause(beams, lengths, found)}",
    )
    besides = [set(cells) - (set(crossed) - {end}) for crossed, end, cells in zip(lengths, ends, found, strict=True)]
    ended = [n for n in range(BEAMS) if besides[n] == {ends[n]}]
    number = max(range(BEAMS), key=lambda n: len(besides[n]))
    expect(
        "there are no others, nor the one in which it ends",
        not any(besides),
        f"For {_written(beams[ended[0]])} it has {ends[ended[0]]}, in which the beam ends: that is where something "
        "stands, and it must not be called free."
        if ended and sum(map(bool, besides)) == len(ended)
        else f"For {_written(beams[number])} it has {len(besides[number])} cells that the beam does not pass, such as "
        f"{min(besides[number], default=None)}. {_beam_cause(beams, lengths, found)}",
    )


def _beam() -> tuple[float, float, float, float, float]:
    """x, y, angle, distance and resolution of one; it stays in the positive quadrant."""
    while True:
        x, y, angle = chance().uniform(0.5, 3.0), chance().uniform(0.5, 3.0), chance().uniform(-math.pi, math.pi)
        distance, resolution = chance().uniform(0.02, 3.0), chance().choice((0.05, 0.1, 0.2))
        if min(x + distance * math.cos(angle), y + distance * math.sin(angle)) > 0.0:
            return x, y, angle, distance, resolution


def _is_cell(pair: Any) -> bool:
    return (
        isinstance(pair, list) and len(pair) == 2 and all(isinstance(n, int) and not isinstance(n, bool) for n in pair)
    )


def _written(beam: tuple[float, ...]) -> str:
    return f"cells_of_beam({', '.join(f'{number:.4g}' for number in beam)})"


def _cell_at(x: float, y: float, angle: float, distance: float, resolution: float) -> Cell:
    """The cell in which a beam ends."""
    across, up = x + distance * math.cos(angle), y + distance * math.sin(angle)
    return math.floor(up / resolution), math.floor(across / resolution)


def _crossed(x: float, y: float, angle: float, distance: float, resolution: float) -> dict[Cell, float]:
    """How many metres of a beam lie in each cell."""
    cuts = [0.0, distance]
    for start, way in ((x, math.cos(angle)), (y, math.sin(angle))):
        low, high = sorted((start / resolution, (start + way * distance) / resolution))
        cuts += [(line * resolution - start) / way for line in range(math.ceil(low), math.floor(high) + 1)]
    cuts = sorted(cut for cut in cuts if 0.0 <= cut <= distance)
    lengths: dict[Cell, float] = {}
    for begin, end in pairwise(cuts):
        cell = _cell_at(x, y, angle, (begin + end) / 2, resolution)
        lengths[cell] = lengths.get(cell, 0.0) + end - begin
    return lengths


def _beam_cause(beams: list[Any], lengths: list[dict[Cell, float]], found: list[list[Cell]]) -> str:
    """What was mixed up, as a hint."""
    whole = list(zip(beams, lengths, found, strict=True))

    def share(cells_of: Any) -> float:
        return sum(len(set(cells) & set(cells_of(beam, crossed))) for beam, crossed, cells in whole) / max(
            1, sum(map(len, found))
        )

    if share(lambda beam, crossed: crossed) > 0.9:
        return (
            "The cells are right, but there are holes: points along the beam that are further apart than a fifth of a "
            "cell miss what it crosses by no more than that."
        )
    if share(lambda beam, crossed: [(column, row) for row, column in crossed]) > 0.9:
        return "It has rows and columns the other way round: the row follows y, the column x."
    if share(lambda beam, _: _crossed(beam[0], beam[1], math.radians(beam[2]), beam[3], beam[4])) > 0.9:
        return "The angle is in radians already."
    return "Row: y + way · sin(angle), column: x + way · cos(angle), each divided by the resolution and rounded down."
