"""Answers to robot-3: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

BEAM = worked("robot-3")

EXACT_BEAM = """
def cells_of_beam(x, y, angle, distance, resolution):
    east, north = math.cos(angle), math.sin(angle)
    cuts = {0.0, distance}
    for start, way in ((x, east), (y, north)):
        if abs(way) > 1e-12:
            lines = np.arange(-1, 300) * resolution
            cuts |= {float(cut) for cut in (lines - start) / way if 0 < cut < distance}
    cuts, cells = sorted(cuts), []
    for a, b in zip(cuts, cuts[1:]):
        middle = (a + b) / 2
        cells.append((int((y + middle * north) // resolution), int((x + middle * east) // resolution)))
    return cells[:-1]
"""
ARRAY_BEAM = """
def cells_of_beam(x, y, angle, distance, resolution):
    ways = np.linspace(0.0, distance, 2000)
    points = np.column_stack([y + ways * np.sin(angle), x + ways * np.cos(angle)])
    cells = np.unique(np.floor(points / resolution).astype(int), axis=0)
    end = np.floor(points[-1] / resolution).astype(int)
    return cells[(cells != end).any(axis=1)]
"""

ANSWERS = Answers(
    "robot-3",
    3,
    BEAM,
    [
        Wrong(
            "swapped",
            changed(
                BEAM,
                (
                    "math.floor(up / resolution), math.floor(across / resolution)",
                    "math.floor(across / resolution), math.floor(up / resolution)",
                ),
            ),
            1,
            "the other way round",
        ),
        Wrong(
            "end_freed",
            changed(BEAM, ("    cells.pop(cell_at(distance), None)\n", "")),
            2,
            "something stands",
        ),
        Wrong("steps", changed(BEAM, ("resolution / 50", "resolution")), 2, "there are holes"),
        Wrong(
            "degrees",
            changed(BEAM, ("    def cell_at", "    angle = math.radians(angle)\n\n    def cell_at")),
            1,
            "radians already",
        ),
        Wrong("floats", changed(BEAM, ("math.floor(up / resolution)", "up // resolution")), 0, "is a float"),
        Wrong(
            "twice",
            changed(
                BEAM,
                (
                    "    cells = dict.fromkeys(cell_at(way) for way in ways)\n"
                    "    cells.pop(cell_at(distance), None)\n    return list(cells)",
                    "    return [cell_at(way) for way in ways if cell_at(way) != cell_at(distance)]",
                ),
            ),
            2,
            "is there twice",
        ),
    ],
    {"exact": EXACT_BEAM, "array": ARRAY_BEAM},
)
