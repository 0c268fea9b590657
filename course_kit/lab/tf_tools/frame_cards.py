"""The boxes of a drawn tree of frames, the lines to them, and the same in words. Pure, no ROS."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence

from course_kit.lab.tf_tools.frame_tree import lay_out
from course_kit.lab.tf_tools.frames import Frame, loops, roots
from course_kit.ros.graph.cards import NAME, PAD_X, PAD_Y, SMALL, Card, Measure, Wire, stacked, widest
from course_kit.ros.graph.layers import Box, Line

BESIDE = 0.15  # inches from a box to a line that leads back
NOTHING = "no node says where a frame is in this domain"


def cards(frames: Sequence[Frame], measure: Measure) -> tuple[list[Card], list[tuple[Wire, Frame]], float, float]:
    """The boxes in their places, a line to each frame from its parent, and width and height of all, in inches."""
    by_name = {frame.name: frame for frame in frames}
    wrong = {frame.name: lines for frame in frames if (lines := troubles(frame, frames))}
    tops = [*roots(frames), *(loop[-1] for loop in loops(frames))]
    made = {name: _card(name, by_name.get(name), wrong, measure) for name in dict.fromkeys([*tops, *by_name])}
    children: dict[str, list[str]] = defaultdict(list)
    for frame in frames:
        children[frame.parent].append(frame.name)
    boxes = {name: card.box for name, card in made.items()}
    width, height = lay_out(boxes, children, tops)
    below = height + BESIDE
    wires = [(_wire(boxes[one.parent], boxes[one.name], below, one.name in wrong), one) for one in frames]
    if loops(frames):
        width, height = width + BESIDE, below
    return list(made.values()), wires, width, height


def _card(name: str, frame: Frame | None, wrong: Mapping[str, Sequence[str]], measure: Measure) -> Card:
    rows = [(name, NAME, "name")]
    if frame is not None:
        rows += [(line, SMALL, "detail") for line in details(frame)]
        rows += [(f"✗ {line}", SMALL, "trouble") for line in wrong.get(name, ())]
    texts, height = stacked(rows, PAD_Y)
    box = Box(name, "", True, widest(texts, measure) + 2 * PAD_X, height, (height / 2,))
    return Card(box, "node", texts, [(0.0, height)], is_broken=name in wrong)


def _wire(parent: Box, child: Box, below: float, is_broken: bool) -> Wire:
    """To the right; or, where a frame is in one that is in it, back below all."""
    start = (parent.x + parent.width, parent.y + parent.ports[0])
    end = (child.x, child.y + child.ports[0])
    way = [start, end]
    if end[0] < start[0]:
        right, left = start[0] + BESIDE, end[0] - BESIDE
        way = [(right, start[1]), (right, below), (left, below), (left, end[1])]
    line = Line(parent.key, child.key, 0, True, points=[start, *way, end])
    return Wire(line, reliable=True, latched=False, is_broken=is_broken)


def details(frame: Frame) -> list[str]:
    """How often a frame comes and from whom."""
    how = "static" if frame.is_static else "once" if frame.rate is None else f"{frame.rate:.3g} Hz"
    return [how, *(f"from {name}" for name in frame.broadcasters)]


def troubles(frame: Frame, among: Sequence[Frame]) -> list[str]:
    """What is wrong with a frame among all, in words."""
    found = ["in a loop: it is in itself" for loop in loops(among) if frame.name in loop]
    if frame.other_parents:
        found.append(f"in {' and in '.join((frame.parent, *frame.other_parents))}: a frame has one parent")
    if len(frame.broadcasters) > 1:
        found.append(f"{len(frame.broadcasters)} nodes say where it is")
    if frame.is_late:
        found.append(f"last {frame.age:.3g} s ago")
    return found


def heading(frames: Sequence[Frame]) -> str:
    """How many frames and trees there are."""
    if not frames:
        return NOTHING.capitalize()
    trees = len(roots(frames)) + len(loops(frames))
    count = len({frame.name for frame in frames} | set(roots(frames)))
    text = f"{count} frames"
    return text if trees == 1 else f"{text}  ·  {trees} trees, and nothing says where one is in the other"


def in_words(frames: Sequence[Frame]) -> str:
    """The trees, frame by frame: where each is, how often that comes and from whom, and what is wrong."""
    told = [f"{heading(frames)}."]
    if tops := roots(frames):
        told.append(f"At the root: {', '.join(tops)}.")
    for frame in frames:
        wrong = "".join(f" Wrong: {line}." for line in troubles(frame, frames))
        told.append(f"{frame.name} in {frame.parent} ({', '.join(details(frame))}).{wrong}")
    return " ".join(told)
