"""The check of services-5: a turtle draws a star when it is asked to."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from std_srvs.srv import Trigger
from turtlesim.srv import Kill, Spawn

from course_kit.exercises.checker import trails
from course_kit.exercises.checker.assertions import (
    a_turtle,
    answer,
    chance,
    expect,
    pause,
    place_turtle,
    require,
    time_left,
    wait,
    wait_for_servers,
)
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.service_assertions import Answer, Client, expect_service, no_answer, wait_for_answers
from course_kit.exercises.checker.topic_assertions import hear_the_turtle, ticked_late
from course_kit.robots.turtlesim.node import TurtleSim
from course_kit.ros.observing.received_messages import ReceivedMessages

REFUSAL = 3.5  # seconds in which it says that there is no turtle: 3, and half a one for a busy machine
STAR = 60.0  # seconds in which it draws
STANDSTILL = 10.0  # seconds without any movement after which it counts as hanging
QUICK = 3.0  # seconds; who draws so quickly is asked once or twice more, since mistakes with ticks are a matter of luck
ARRIVED = 0.2  # metres
NOTHING = 0.6  # metres of line; who drives may be late in a curve on a busy machine, and the way there is 2 m and more
TWICE = 2.0  # metres of line; who drives may go back and forth a little
WIDTH = 4  # pixels
TRIES = 3


@dataclass
class Star:
    """One call of /draw_star, and what was drawn for it."""

    answered: Answer
    missing: float  # metres to the end of the last line, and to where the turtle came to rest, when the response came
    seen: trails.StarSeen

    @property
    def said(self) -> str:
        """What the response said."""
        said = self.answered.response
        return "No response came" if said is None else f"It said success={said.success}, {said.message!r}"

    @property
    def is_answered(self) -> bool:
        """True if the response is right, and came when the turtle had arrived."""
        said = self.answered.response
        return bool(said and said.success and said.message == "5 lines" and self.missing <= ARRIVED)

    @property
    def is_star(self) -> bool:
        """True if all lines are there, whatever else is."""
        return self.seen.yellow == 5 and self.seen.strokes == 1

    @property
    def is_alone(self) -> bool:
        """True if nothing else was drawn."""
        return self.seen.complete > 0 and self.seen.elsewhere < NOTHING and self.seen.again < TWICE

    @property
    def is_right(self) -> bool:
        """True if nothing is missing."""
        return self.is_answered and self.is_star and self.is_alone and self.seen.widths == (WIDTH,)


class Scene(NamedTuple):
    """The turtle's simulator, its poses, and what is drawn."""

    turtlesim: TurtleSim
    driven: ReceivedMessages
    drawing: trails.Drawing


@check_of("services-5")
def star_painter() -> None:
    """It draws a star whenever it is asked, answers when it is there, and says so if there is no turtle."""
    answer(threads=None)
    client = expect_service("/draw_star", Trigger)
    refusals = [client.ask(REFUSAL + 0.5)]
    if refusals[0].response is None:  # what hangs may keep it from answering again
        client = _made_again()
    turtlesim = a_turtle()
    _have_teleports_happen_late(turtlesim)
    scene = Scene(turtlesim, hear_the_turtle(), trails.Drawing(turtlesim.world))
    stars = [_star(scene, client)]
    if stars[0].answered.response is not None:
        refusals.append(_ask_without_its_turtle(client))
        client = Client("/draw_star", Trigger) if refusals[-1].response is not None else _made_again()
    _expect_refusals(refusals)
    require("with a turtle it answers", stars[0].answered.response is not None, _why_no_answer(stars[0]))
    stars.append(_star(scene, client))
    while len(stars) < 4 and all(one.answered.response and one.answered.seconds < QUICK for one in stars):
        stars.append(_star(scene, client))
    _expect_stars(stars)


def _made_again() -> Client:
    answer(threads=None)
    return Client("/draw_star", Trigger)


def _have_teleports_happen_late(turtlesim: TurtleSim) -> None:
    """Have the first teleport after a tick happen a whole tick later: so late do some of them, by chance."""
    (timer,) = turtlesim.timers
    world: Any = turtlesim.world

    def late(plain: Any) -> Any:
        def teleport(name: str, *to: float) -> None:
            if name in world.turtles and not world.turtles[name].teleports:
                timer.reset()
            plain(name, *to)

        return teleport

    world.teleport_absolute, world.teleport_relative = late(world.teleport_absolute), late(world.teleport_relative)


def _star(scene: Scene, client: Client) -> Star:
    """The star of one call; once or twice more where it is not right and the simulator may have caused that."""
    for _ in range(TRIES):
        before = len(scene.driven)
        star = _one_star(scene, client)
        in_time = star.answered.response and time_left() > 3 * star.answered.seconds + QUICK
        if star.is_right or not in_time or not ticked_late(scene.driven, before):
            break
    return star


def _one_star(scene: Scene, client: Client) -> Star:
    """Put the turtle somewhere in a corner of the field, with another pen, and have it draw; until it is at rest."""
    world = scene.turtlesim.world
    wait_for_servers(2.0)
    x, y = (chance().choice((0, 9)) + chance().uniform(0.5, 1.5) for _ in range(2))
    world.set_pen("turtle1", (0, 0, 0), 1, off=True)
    place_turtle(scene.turtlesim, x, y, chance().uniform(-3, 3))
    red, green, blue = (chance().randint(0, 200) for _ in range(3))
    world.set_pen("turtle1", (red, green, blue), chance().choice((1, 2, 7, 9)), off=False)
    scene.drawing.lines.clear()
    pause(0.1)  # its pose has come to whoever listens
    answered = client.send(lambda: trails.place(world))
    _wait_while_it_moves(world, answered)
    wait_for_answers(0.0, answered)
    _wait_for_rest(world)
    at, end = answered.seen, trails.place(world)
    missing = math.inf
    if at and end and (lines := scene.drawing.lines):
        missing = max(math.dist(at[:2], there) for there in (end[:2], lines[-1].end))
    return Star(answered, missing, trails.star_seen(scene.drawing.lines))


def _wait_while_it_moves(world: Any, answered: Answer) -> None:
    moved, at = time.monotonic(), trails.place(world)

    def is_over() -> bool:
        nonlocal moved, at
        if (now := trails.place(world)) != at:
            moved, at = time.monotonic(), now
        return answered.response is not None or time.monotonic() - moved > STANDSTILL

    wait(is_over, STAR, "the response of /draw_star")


def _wait_for_rest(world: Any) -> None:
    """Wait until it has stood still for a tenth of a second, or 2 s are over."""
    for _ in range(20):
        before = trails.place(world)
        pause(0.1)
        if trails.place(world) == before:
            return


def _ask_without_its_turtle(client: Client) -> Answer:
    """Kill turtle1, call, and have it spawned again."""
    Client("/kill", Kill).ask(name="turtle1")
    pause(1.1)  # who goes by how old its pose is needs to see it grow old
    refused = client.ask(REFUSAL + 0.5)
    Client("/spawn", Spawn).ask(name="turtle1", x=5.0, y=5.0)
    return refused


def _expect_refusals(refusals: list[Answer]) -> None:
    """The first without any turtle, the second after turtle1 was killed."""
    wrong = [one for one in refusals if one.response is None or one.response.success or one.seconds > REFUSAL]
    seen = wrong[0] if wrong else refusals[0]
    expect(
        "without a turtle it says so within 3 s",
        not wrong,
        f"{'No response came' if seen.response is None else f'It said success={seen.response.success}'} after "
        f"{seen.seconds:.1f} s, {'without a turtlesim' if seen is refusals[0] else 'after turtle1 was killed'}: look "
        f"in each call at what wait_for_service(timeout_sec=…) returns, before you call the turtle's services.",
    )


def _why_no_answer(star: Star) -> str:
    still = f" The turtle had not moved for {STANDSTILL:g} s." if star.answered.seconds < STAR else ""
    return no_answer("/draw_star", round(star.answered.seconds)) + still


def _expect_stars(stars: list[Star]) -> None:
    number, star = _first_not(stars, lambda one: one.is_answered)
    expect(
        "it answers `5 lines` when it has arrived",
        star.is_answered,
        f"{star.said}, in call {number}, with the turtle {star.missing:.1f} m from the end of the last line. The "
        f"message is `5 lines`, and a teleport happens after its response: wait for its pose, then respond.",
    )
    number, star = _first_not(stars, lambda one: one.is_star)
    expect(
        "five lines of a star, in one stroke, in yellow",
        star.is_star,
        f"In call {number}, {star.seen.yellow} of the 5 lines are there in yellow, {star.seen.complete} in any colour, "
        f"drawn in {star.seen.strokes} strokes: corners 4 m from (5.54, 5.54) at 90°, 234°, 18°, 162°, 306°, and the "
        f"pen stays down from the first to the last. Before each call the turtle was put elsewhere, with another pen. "
        f"`turtlesim.picture()` shows what was drawn.",
    )
    number, star = _first_not(stars, lambda one: one.seen.widths == (WIDTH,))
    expect(
        "they are 4 pixels wide",
        star.seen.widths == (WIDTH,),
        f"In call {number} they are {' and '.join(map(str, star.seen.widths))} wide: `width=4` in the request of "
        f"set_pen, each time."
        if star.seen.widths
        else f"In call {number} there is no line of a star.",
    )
    number, star = _first_not(stars, lambda one: one.is_alone)
    expect(
        "nothing else is drawn",
        star.is_alone,
        f"In call {number}, {star.seen.elsewhere:.1f} m are drawn beside the star, and {star.seen.again:.1f} m of it "
        "twice: lift the pen (`off=1`) for the way to the first corner. A teleport happens at the next tick, after "
        "its response: wait for the pose before the pen goes down."
        if star.seen.complete
        else f"In call {number} there is no star yet.",
    )


def _first_not(stars: list[Star], is_good: Callable[[Star], bool]) -> tuple[int, Star]:
    """The first star that is not good, or the first of all; counted from 1."""
    return next(((n, one) for n, one in enumerate(stars, start=1) if not is_good(one)), (1, stars[0]))
