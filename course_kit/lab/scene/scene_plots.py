"""Scans, paths, maps and poses in one picture, seen from above: what rviz2 is used for first."""

from __future__ import annotations

from itertools import cycle
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.patches import Patch
from matplotlib.transforms import Affine2D

from course_kit.base.alternative_text import span
from course_kit.base.arguments import TEXT, WAIT, takes
from course_kit.base.figures import COLOURS, FAINT, INK, LINES, PANEL, Plot, style
from course_kit.base.polling import wait_until
from course_kit.lab.scene.frames import TRANSFORMS, Float64s, Frames
from course_kit.lab.scene.given import listening, messages
from course_kit.lab.scene.scene import UNKNOWN, Layer, Scene, is_known, layer, scene
from course_kit.ros.subscriptions import topics

# Free, occupied and unknown cells; the ground outside a map is white, so free is not.
FREE, OCCUPIED, NOT_KNOWN = "#e9eef4", "#15181c", "#a9aca6"
WIDTH, TALLEST = 7.6, 8.0  # inches
TRANSFORM_TIMEOUT, LOOK = 1.0, 0.05  # seconds for the transforms of a scan to come after it, and between two looks
ARROWS = 60  # poses of a path or an array that have an arrow, at most
X_AXIS, Y_AXIS = "#c0392b", "#1e8449"  # of frames: red and green as everywhere in ROS
NEAR, NAMES = 0.04, 2  # share of the picture within which frames are drawn as one, and how many names that has
ORDER = {"grid": 0, "scan": 1, "points": 2, "path": 3, "poses": 4}


@takes(frame=TEXT | None, title=TEXT | None, timeout=WAIT)
def plot_scene(
    *shown: Any, frame: str | None = None, title: str | None = None, timeout: float = 5.0, **named: Any
) -> Plot:
    """Draw messages in one frame, seen from above, one layer each: `plot_scene(map, scan=scan)`.

    Takes LaserScan, Path, OccupancyGrid, PoseArray, PoseStamped, PoseWithCovarianceStamped, Odometry, PointStamped and
    PolygonStamped messages, topics of these (the next message is waited for, up to `timeout` seconds) and recordings
    of them (the last message). A keyword is the layer's name. `frame` is that of the first layer unless given; a layer
    in another frame is put where that was at the layer's stamp, as tf2 has it: by Odometry, TransformStamped and
    TFMessage messages, all those of a recording of them, and, where topics are given, /tf and /tf_static. If none of
    them tells, it is left out, which one line below the figure says. Raises ValueError if nothing can be drawn.
    """
    given = [
        (label, topics.absolute(one) if isinstance(one, str) else one)
        for label, one in [*((None, one) for one in shown), *named.items()]
    ]
    with listening([one for _, one in given if isinstance(one, str)]) as heard:
        found = messages(given, timeout)
        layers = [
            layer(message, kind, one.label) for one in found for message, kind in [one.last()] if kind not in TRANSFORMS
        ]

        def frames() -> Frames:
            known = Frames()
            for one in (*found, *heard()):
                for message in one.telling:
                    known.add(message, one.kind, one.topic.endswith("tf_static"))
            return known

        if heard():
            wait_until(lambda: is_known(layers, frames(), frame), min(timeout, TRANSFORM_TIMEOUT), LOOK)
        return draw_scene(scene(layers, frames(), frame), title)


def draw_scene(placed: Scene, title: str | None = None) -> Plot:
    """Draw a scene."""
    low, high = _limits(placed)
    width, height = high - low
    drawn_height = min(TALLEST, max(2.4, WIDTH * height / width))
    plot = Plot(WIDTH, drawn_height, title)
    where = f" in frame '{placed.frame}'" if placed.frame else ""
    axes = style(plot.subplots(), f"x [m]{where}", "y [m]")
    handles: list[Any] = []
    colours = cycle(COLOURS)
    for one in sorted(placed.layers, key=lambda one: (ORDER[one.kind], -len(one.poses))):
        if one.kind == "grid":
            handles += _draw_grid(axes, one)
        else:
            handles.append(_draw_layer(axes, one, next(colours)))
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal")
    for places in _together(placed.axes, NEAR * max(width, height)):
        _draw_axes(axes, places)
    columns = min(4, len(handles))
    rows = -(-len(handles) // columns)
    axes.legend(
        handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, fontsize=8.5, frameon=False,
        labelcolor=INK, borderaxespad=0.2,
    )  # fmt: skip
    plot.set_figheight(drawn_height + 0.6 + 0.2 * (rows + len(placed.notes)) + (0.3 if title else 0.0))
    if placed.notes:
        plot.supxlabel("\n".join(placed.notes), color="#a8320a", fontsize=9, x=0.02, ha="left")
    plot.description = _in_words(placed)
    return plot


def _in_words(placed: Scene) -> str:
    told = [f"Seen from above, in frame '{placed.frame}'." if placed.frame else "Seen from above."]
    told += [f"{one.label}: {_layer_in_words(one)}." for one in placed.layers]
    for name, place in placed.axes.items():
        turned = np.arctan2(place[1, 0], place[0, 0])
        told.append(f"Frame '{name}' is at ({place[0, 3]:.2f}, {place[1, 3]:.2f}) m, turned by {turned:.2f} rad.")
    return " ".join([*told, *(f"{note}." for note in placed.notes)])


def _layer_in_words(one: Layer) -> str:
    if one.cells is not None:
        height, width = one.cells.shape
        known = one.cells[(one.cells >= 0) & (one.cells <= 100)]
        share = 100 * (known > 50).sum() / one.cells.size, 100 * (known <= 50).sum() / one.cells.size
        return (
            f"a map of {width} by {height} cells of {one.resolution:g} m, {_extent(one.points)}, "
            f"{share[0]:.0f} % occupied, {share[1]:.0f} % free, the rest unknown"
        )
    if one.kind == "scan":
        away = np.hypot(*(one.points[:, :2] - one.poses[0][:2, 3]).T)
        return f"a scan with {len(away)} hits" + (f", {span(away, 'm')} away" if len(away) else "")
    if not len(one.points):
        return "empty"
    if one.kind == "poses":
        turned = np.arctan2(one.poses[:, 1, 0], one.poses[:, 0, 0])
        what = "a pose" if len(one.poses) == 1 else f"{len(one.poses)} poses"
        return f"{what}, {_extent(one.points)}, heading {span(turned, 'rad')}"
    if one.kind == "path":
        (x0, y0), (x1, y1) = one.points[[0, -1], :2]
        length = np.hypot(*np.diff(one.points[:, :2], axis=0).T).sum()
        return f"a path from ({x0:.2f}, {y0:.2f}) m to ({x1:.2f}, {y1:.2f}) m, {length:.2f} m long"
    return f"{len(one.points)} point{'s' if len(one.points) != 1 else ''}, {_extent(one.points)}"


def _extent(points: Float64s) -> str:
    return f"x {span(points[:, 0], 'm')}, y {span(points[:, 1], 'm')}"


def _draw_grid(axes: Axes, grid: Layer) -> list[Patch]:
    """A map: cell [0, 0] at its origin, rows along its y axis, turned as its origin is."""
    assert grid.cells is not None
    origin, (height, width) = grid.poses[0], grid.cells.shape
    turned = Affine2D(_in_plane(origin)) + axes.transData
    side = grid.resolution
    axes.imshow(
        shades(grid.cells), origin="lower", extent=(0, width * side, 0, height * side), transform=turned,
        interpolation="nearest", aspect="auto", zorder=0.6,
    )  # fmt: skip
    outline = np.vstack([grid.points, grid.points[:1]])
    axes.plot(outline[:, 0], outline[:, 1], color=FAINT, linewidth=0.8, zorder=1)
    edge: dict[str, Any] = {"edgecolor": FAINT, "linewidth": 0.6}
    names = {f"{grid.label}: free": FREE, "occupied": OCCUPIED, "unknown": NOT_KNOWN}
    return [Patch(facecolor=colour, label=name, **edge) for name, colour in names.items()]


def _in_plane(pose: Float64s) -> Float64s:
    """The part of a 4 by 4 pose that is seen from above, as matplotlib's 3 by 3."""
    flat = np.eye(3)
    flat[:2, :2], flat[:2, 2] = pose[:2, :2], pose[:2, 3]
    return flat


def shades(cells: npt.NDArray[np.int8]) -> npt.NDArray[np.uint8]:
    """The colours of a map's cells, opaque: from free (0) to occupied (100), one for unknown; (height, width, 4)."""
    free, occupied = np.array(to_rgb(FREE)), np.array(to_rgb(OCCUPIED))
    share = np.arange(101)[:, None] / 100.0
    known = free * (1 - share) + occupied * share
    table = np.tile(np.array(to_rgb(NOT_KNOWN)), (256, 1))
    table[:101] = known  # of int8 seen as uint8: 0 to 100, then what is no probability, with -1 as 255
    assert np.int8(UNKNOWN).view(np.uint8) == 255
    opaque = np.column_stack([np.round(table * 255), np.full(256, 255)]).astype(np.uint8)
    return np.asarray(opaque[cells.view(np.uint8)], np.uint8)


def _draw_layer(axes: Axes, one: Layer, colour: str) -> Any:
    x, y = one.points[:, 0], one.points[:, 1]
    empty = "" if len(one.points) or one.kind == "scan" else " (empty)"
    name = f"{one.label}{empty}"
    if one.kind == "scan":
        place = one.poses[0]
        axes.plot(*place[:2, 3], marker="o", markersize=6, color=PANEL, markeredgecolor=colour, zorder=3)
        return axes.plot(x, y, ".", color=colour, markersize=4, label=f"{name} ({len(x)} hits)", zorder=2.5)[0]
    if one.kind == "points":
        line = "-" if len(x) > 2 else ""
        return axes.plot(x, y, color=colour, marker="o", markersize=4, linestyle=line, label=name, zorder=2.6)[0]
    if one.kind == "path":
        (handle,) = axes.plot(x, y, color=colour, linewidth=2.0, label=name, zorder=3)
        axes.plot(x[:1], y[:1], "o", color=PANEL, markeredgecolor=colour, markeredgewidth=2, markersize=8, zorder=4)
        axes.plot(x[-1:], y[-1:], "s", color=colour, markeredgecolor=PANEL, markersize=7, zorder=4)
        return handle
    _draw_arrows(axes, one.poses, colour)
    size, order = (8, 6) if len(x) == 1 else (4, 5)
    edge: dict[str, Any] = {"markeredgecolor": PANEL, "markeredgewidth": 0.6}
    return axes.plot(x, y, "o", color=colour, markersize=size, label=name, zorder=order, **edge)[0]


def _draw_arrows(axes: Axes, poses: Float64s, colour: str) -> None:
    """An arrow along the x axis of each pose: where it looks to."""
    chosen = poses[:: max(1, -(-len(poses) // ARROWS))]
    is_one = len(poses) == 1
    scale, width = (3.0, 0.035) if is_one else (5.5, 0.018)
    if len(chosen):
        axes.quiver(
            chosen[:, 0, 3], chosen[:, 1, 3], chosen[:, 0, 0], chosen[:, 1, 0], color=colour, units="inches",
            scale=scale, scale_units="inches", width=width, headwidth=5, headlength=5, headaxislength=4.5,
            zorder=4.5 + is_one,
        )  # fmt: skip


def _limits(placed: Scene) -> tuple[Float64s, Float64s]:
    """The lower left and the upper right corner of what shows every layer, with some room."""
    parts = [one.points[:, :2] for one in placed.layers] + [one.poses[:, :2, 3] for one in placed.layers]
    points = np.vstack(parts)
    points = points[np.isfinite(points).all(axis=1)]
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(2), np.zeros(2))
    room = max(0.06 * float((high - low).max()), 0.25)
    return low - room, high + room


def _together(places: dict[str, Float64s], near: float) -> list[dict[str, Float64s]]:
    """Frames whose names would lie on one another, as the parts of a robot do, each group by its first."""
    groups: list[dict[str, Float64s]] = []
    for name, place in places.items():
        first = (next(iter(group.values())) for group in groups)
        for group, other in zip(groups, first, strict=False):
            if np.hypot(*(place[:2, 3] - other[:2, 3])) < near:
                group[name] = place
                break
        else:
            groups.append({name: place})
    return groups


def _draw_axes(axes: Axes, places: dict[str, Float64s]) -> None:
    """The axes of the first of frames that are near each other, x red and y green, if that is in sight."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    place = next(iter(places.values()))
    x, y = place[:2, 3]
    if not (left <= x <= right and low <= y <= high):
        return
    length = 0.07 * max(right - left, high - low)
    for column, colour in ((0, X_AXIS), (1, Y_AXIS)):
        end = place[:2, 3] + length * place[:2, column]
        axes.plot([x, end[0]], [y, end[1]], color=colour, linewidth=2.4, solid_capstyle="round", zorder=4.2)
    names = [*places]
    if len(names) > NAMES:
        names[1:] = [f"and {len(names) - 1} more"]
    box = {"facecolor": PANEL, "edgecolor": LINES, "alpha": 0.85, "boxstyle": "round,pad=0.15", "linewidth": 0.6}
    axes.annotate(
        "\n".join(names), (x, y), xytext=(-5, -6), textcoords="offset points", ha="right", va="top", fontsize=8,
        color=INK, zorder=7, bbox=box,
    )  # fmt: skip
