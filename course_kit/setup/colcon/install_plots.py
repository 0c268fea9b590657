"""The installed files of a package as a picture: each with its source, and who looks for it there."""

from __future__ import annotations

import filecmp
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

from course_kit.base.arguments import TEXT, shown, takes
from course_kit.base.figures import COLOURS, FAINT, INK, LINES, PANEL, Plot, as_ink
from course_kit.setup.colcon.workspaces import Workspace

# Who looks for an installed file: the place of it, in the prefix of its package, and what finds it there.
READERS = (
    (r"lib/{package}/[^/]+", "ros2 run"),
    (r"lib/python[\d.]+/site-packages/{package}/.*|local/lib/.*/dist-packages/{package}/.*", "import"),
    (r"share/{package}/launch/.*", "ros2 launch"),
    (r"share/{package}/package\.xml", "ros2 pkg xml"),
    (r"share/{package}/(?!hook/|package\.|local_setup\.|cmake/|environment/).*", "nodes, launch files"),
    (r"share/ament_index/resource_index/packages/.*", "ros2, nodes: to find it"),
)
ROW = 0.3  # inches
LEFT, MIDDLE, RIGHT, WIDTH = 0.0, 3.2, 8.4, 10.4


@dataclass(frozen=True)
class Installed:
    """An installed file, by its path in the package's prefix, and the file of `src` that it was made from."""

    source: str
    target: str
    reader: str


def installed(workspace: Workspace, package: str) -> list[Installed]:
    """What was installed of a package, in the order of its readers. ValueError if it was not built."""
    source, prefix = workspace.src / package, workspace.install / package
    if not prefix.is_dir():
        raise ValueError(f"there is no {package} in {workspace.install}: was it built?")
    files = sorted(path for path in prefix.rglob("*") if path.is_file() and path.suffix != ".pyc")
    found: dict[Path, Installed] = {}
    for pattern, reader in READERS:
        for path in files:
            target = str(path.relative_to(prefix))
            if path not in found and re.fullmatch(pattern.format(package=re.escape(package)), target):
                found[path] = Installed(_origin(path, source), target, reader)
    return list(found.values())


def _origin(path: Path, source: Path) -> str:
    """The file that was copied there; a script is made from an entry point."""
    same = [file for file in sorted(source.rglob(path.name)) if file.is_file()]
    copied = [file for file in same if filecmp.cmp(file, path, shallow=False)]
    if copied:
        # Of two equal files, the one in the folder of the same name is the origin.
        return str(min(copied, key=lambda file: file.parent.name != path.parent.name).relative_to(source))
    setup = source / "setup.py"
    if setup.is_file() and re.search(rf"['\"]{re.escape(path.name)}\s*=", setup.read_text(errors="replace")):
        return "setup.py: entry_points"
    return "CMakeLists.txt: install()" if (source / "CMakeLists.txt").is_file() else ""


@takes(package=TEXT)
def plot_install(workspace: Workspace, package: str) -> Plot:
    """The files of a package in `src`, those that colcon made of them in `install`, and what looks for them there."""
    if not isinstance(workspace, Workspace):
        raise TypeError(f"plot_install() draws what Workspace() gave, not {shown(workspace)}")
    rows = installed(workspace, package)
    readers = list(dict.fromkeys(row.reader for row in rows))
    plot = Plot(WIDTH, ROW * (len(rows) + 2) + 0.4, f"What colcon build made of {package}")
    axes = plot.subplots()
    axes.set(xlim=(-0.1, WIDTH), ylim=(len(rows) - 0.3, -1.5))
    axes.axis("off")
    for x, title in ((LEFT, f"src/{package}/"), (MIDDLE, f"install/{package}/"), (RIGHT, "who looks there")):
        axes.text(x, -1.0, title, color=INK, fontsize=10, fontweight="bold", va="center")
    sources = _places([row.source for row in rows])
    finders = _places([row.reader for row in rows])
    for text, y in sources.items():
        axes.text(LEFT, y, text, color=INK, fontsize=9, va="center", family="monospace")
    for number, row in enumerate(rows):
        colour = COLOURS[readers.index(row.reader) % len(COLOURS)]
        box = {"boxstyle": "round,pad=0.25", "facecolor": PANEL, "edgecolor": LINES}
        axes.text(MIDDLE, number, row.target, color=INK, fontsize=9, va="center", family="monospace", bbox=box)
        _arrow(plot, (LEFT + 0.079 * len(row.source), sources[row.source]), (MIDDLE - 0.1, number), FAINT)
        _arrow(plot, (MIDDLE + 0.079 * len(row.target) + 0.1, number), (RIGHT - 0.1, finders[row.reader]), colour)
    for number, reader in enumerate(readers):
        colour = as_ink(COLOURS[number % len(COLOURS)])
        axes.text(RIGHT, finders[reader], reader, color=colour, fontsize=10, va="center")
    told = [f"{row.target}{f' from {row.source}' if row.source else ''}, found by {row.reader}" for row in rows]
    plot.description = f"What colcon build made of src/{package} in install/{package}: {'; '.join(told)}."
    return plot


def _places(texts: Sequence[str]) -> dict[str, float]:
    """Each text once, in the middle of the rows that have it; where rows of two texts mix, apart from each other."""
    middles = {text: fmean(row for row, other in enumerate(texts) if other == text) for text in texts if text}
    places: dict[str, float] = {}
    for text, middle in sorted(middles.items(), key=lambda item: item[1]):
        places[text] = max([middle, *(place + 1.0 for place in places.values())])
    return places


def _arrow(plot: Plot, start: tuple[float, float], end: tuple[float, float], colour: str) -> None:
    style = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.2, "shrinkA": 3, "shrinkB": 0}
    plot.axes[0].annotate("", end, start, arrowprops=style)
