"""The check of actions-5: an action server that draws a star and drives home."""

from __future__ import annotations

import math

from course_kit.exercises.actions.star_driven import CARRIED, CLEARLY_AWAY, COASTED, Star, is_away
from course_kit.exercises.checker.action_assertions import Client, expect_action
from course_kit.exercises.checker.assertions import (
    a_turtle,
    answer,
    chance,
    expect,
    nobody_else,
    place_turtle,
    require,
    time_left,
    wait,
)
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.topic_assertions import hear_the_turtle, ticked_late
from course_kit.robots.turtlesim import paths
from course_kit.robots.turtlesim.field import EXTENT, MIDDLE
from course_kit.robots.turtlesim.node import TurtleSim

SMALL, BIG = (1.1, 1.3), (1.6, 1.8)  # metres of a line, from to: no constant is right for both
ROOM = 1.7  # of the length of a line: whoever drives a pentagon stays away from the walls, too
AWAY = 0.3  # metres from where it began at which the turtle is back
CLEAR = 0.6  # metres from the middle and from where the first star began at which a second is sent
TOLD = 1.5  # feedbacks a second, where the text says two
STAR_TIMEOUT, HOME_TIMEOUT, ABORT_TIMEOUT = 42.0, 21.0, 1.5  # seconds, where the text says 40, 20 and 1
PATIENCE = 4.0  # seconds for an abort where its time is not judged
STOP_TIMEOUT = 1.3  # seconds: a turtle obeys its last command for one
USUAL = 14.0  # seconds for a star that does not end, for others what they took
PAIRS = 3  # stars that are begun, at most, until one can be pre-empted on its way
STARS = 6  # times that, in which the check does what is left to do with one star more


class Trip:
    """Where the turtle of the checker was, and the stars that it was sent along."""

    def __init__(self, turtlesim: TurtleSim) -> None:
        self._turtlesim, self._driven = turtlesim, hear_the_turtle()
        self._places = [(MIDDLE, MIDDLE)]

    def put_elsewhere(self, lines: float) -> None:
        """Put the turtle, when it stands still, far from where it was, with room for lines of so many metres."""
        wait(lambda: not self._driven.last.linear_velocity, STOP_TIMEOUT, "the turtle to stand still")
        low, high = ROOM * lines, EXTENT - ROOM * lines
        drawn = [(chance().uniform(low, high), chance().uniform(low, high)) for _ in range(10)]
        place = max(drawn, key=lambda one: min(math.dist(one, other) for other in self._places))
        self._places.append(place)
        place_turtle(self._turtlesim, *place, chance().uniform(-math.pi, math.pi))
        wait(lambda: self._is_at(place), 1.0, "the turtle's pose")

    def _is_at(self, place: paths.Point) -> bool:
        return math.dist((self._driven.last.x, self._driven.last.y), place) < 0.01

    def send(self, client: Client, side: float) -> Star:
        """Send a goal."""
        begun = len(self._driven) - 1
        return Star(side, client.send(side_length=side), begun)

    def drive(self, star: Star, lines: float, timeout: float) -> None:
        """Wait until so many lines are driven, if the goal is accepted, and while it has not ended."""
        length = lines * star.side if star.goal.accepted else 0.0

        def is_driven() -> bool:
            return paths.length(self._driven.messages[star.begun :]) >= length or star.goal.settled is not None

        wait(is_driven, timeout, "a line", poll=0.1)

    def gets_clear(self, star: Star) -> bool:
        """Wait until the turtle is clear of where a wrong star would begin or end; False if its goal ends before."""

        def is_clear() -> bool:
            return is_away(self._driven.last, self._places, CLEAR) or star.goal.settled is not None

        wait(is_clear, 5.0, "the turtle to be clear of where other stars began", poll=0.02)
        return star.goal.settled is None

    def send_second(self, client: Client, side: float) -> Star:
        """Send a goal while another is driven."""
        star = self.send(client, side)
        star.elsewhere = list(self._places)
        return star

    def is_away(self, star: Star) -> bool:
        """Return True if the turtle is away from all places where a star may have begun, or it has no goal any more."""
        self.end(star)
        return star.gap > CLEARLY_AWAY or star.goal.settled is not None

    def was_late(self, star: Star) -> bool:
        """Return True if the simulator was late in it, as on a busy machine, which may lead the turtle astray."""
        return ticked_late(self._driven, star.begun)

    def end(self, star: Star) -> None:
        """Keep how the turtle moved until the goal ended, if it has."""
        until = star.goal.settled or math.inf
        star.arrivals = [one for one in self._driven.arrivals[star.begun :] if one[0] <= until]


@check_of("actions-5")
def star_server() -> None:
    """It drives stars, goes back to where one began when it is cancelled, and lets a second goal win."""
    from my_interfaces.action import Polygon  # the checker's own

    trip = Trip(a_turtle())
    nobody_else("rt/turtle1/cmd_vel")
    sides = [chance().uniform(*sizes) for sizes in chance().sample([SMALL, BIG], 2)]
    trip.put_elsewhere(sides[0])
    answer(threads=None)
    client = expect_action("/drive_star", Polygon)
    star = _whole(trip, client, sides[0])
    usual = star.seconds if math.isfinite(star.seconds) else USUAL
    if star.goal.accepted and trip.was_late(star) and not star.is_drawn() and time_left() > STARS * usual:
        if star.goal.status is None:
            star.goal.cancel(PATIENCE)
        trip.put_elsewhere(sides[0])
        star = _whole(trip, client, sides[0])
    require(
        "it accepts a goal, and the goal ends",
        star.goal.status is not None,
        f"A goal with lines of {star.side:.2f} m is {star.goal.word} after {STAR_TIMEOUT:g} s, in which the turtle "
        f"drove {paths.length(star.poses):.1f} m and turned by {paths.turned(star.poses):.0f}°.",
    )
    unwanted = _cancelled(trip, client)
    if trip.was_late(unwanted) and not _is_home(unwanted) and time_left() > STARS * usual:
        unwanted = _cancelled(trip, client)
    pre_empted, second = _one_after_another(trip, client, *sides, patience=ABORT_TIMEOUT)
    if pre_empted.goal.word == "aborted":  # else two drive the turtle at the same time
        second.goal.wait(STAR_TIMEOUT)
    trip.end(second)
    finished = [star, second] if second.goal.word == "succeeded" else [star]
    _expect_stars(finished)
    _expect_home(unwanted)
    expect(
        "a second goal takes the place of the first",
        pre_empted.goal.word == "aborted" and second.goal.word == "succeeded",
        f"With a second goal on its way the first is {pre_empted.goal.word}, and the second {second.goal.word}: abort "
        "the first, let its loop end, and drive the second.",
    )


def _whole(trip: Trip, client: Client, side: float) -> Star:
    star = trip.send(client, side)
    star.goal.wait(STAR_TIMEOUT)
    trip.end(star)
    return star


def _one_after_another(trip: Trip, client: Client, *sides: float, patience: float) -> list[Star]:
    """Two stars, of which the second is sent when the turtle is clear of where a wrong one would begin or end.

    A small star may be near such places all the way: another is begun elsewhere.
    """
    for _ in range(PAIRS):
        trip.put_elsewhere(sum(sides))
        first = trip.send(client, sides[0])
        trip.drive(first, chance().uniform(0.8, 1.15), timeout=20.0)
        if trip.gets_clear(first):
            break
    second = trip.send_second(client, sides[1])
    first.goal.wait(patience)
    second.other_ended = first.goal.settled or 0
    return [first, second]


def _cancelled(trip: Trip, client: Client) -> Star:
    """A star that is cancelled on its way, and begins in the midst of another, where the answer does that."""
    earlier, star = _one_after_another(trip, client, *(chance().uniform(*SMALL) for _ in range(2)), patience=PATIENCE)
    if earlier.goal.word != "aborted":
        for one in (earlier, star):
            one.goal.cancel(HOME_TIMEOUT)
        trip.put_elsewhere(SMALL[1])
        star = trip.send(client, chance().uniform(*SMALL))
    trip.drive(star, chance().uniform(1.2, 2.1), timeout=25.0)
    wait(lambda: trip.is_away(star), 5.0, "the turtle to be away from where the star may have begun", poll=0.1)
    star.goal.cancel(HOME_TIMEOUT)
    trip.end(star)
    return star


def _expect_stars(stars: list[Star]) -> None:
    """What stars that were driven to their end must be: the second began while the turtle drove another."""
    bad = next((star for star in stars if not star.is_finished), stars[0])
    expect(
        "the goal succeeds, and the result is the metres driven",
        bad.is_finished,
        f"With lines of {bad.side:.2f} m it is {bad.goal.word}, with a distance of {bad.distance:.1f} m: drive all "
        f"five lines, then `goal_handle.succeed()`, and return a result in which `distance` is {bad.lines:.1f}.",
    )
    wrong = [star for n, star in enumerate(stars) if not star.is_drawn(n * COASTED)]
    bad = wrong[0] if wrong else stars[0]
    expect(
        "the path is a star with five points",
        not wrong,
        f"With lines of {bad.side:.2f} m it missed a point by {bad.missed_by:.2f} m, ended {bad.gap:.2f} m from where "
        f"it began, drove {paths.length(bad.poses):.1f} m in place of {bad.lines:.1f}, "
        f"{paths.carried(bad.poses):.1f} m of them by teleports: at each point of a star the turtle turns by 144°, "
        "twice the angle of a pentagon.",
    )
    rates = [len(star.goal.feedback) / star.seconds for star in stars]
    errors = [star.wrong_feedback for star in stars]
    told = [rate > TOLD and error < star.side / 2 + 0.3 for star, rate, error in zip(stars, rates, errors, strict=True)]
    n = told.index(False) if False in told else 0
    left = [message.distance_left for message in stars[n].goal.feedback] or [math.nan]
    expect(
        "the feedback is the metres left",
        all(told),
        f"It came {rates[n]:.1f} times a second, began with {left[0]:.1f} and ended with {left[-1]:.1f}; on average it "
        f"was {errors[n]:.1f} m off. It is what is left of this line and of the lines after it, at the beginning "
        f"{stars[n].lines:.1f}.",
    )


def _is_home(star: Star) -> bool:
    return star.goal.word == "canceled" and star.gap < AWAY and paths.carried(star.poses) < CARRIED


def _expect_home(star: Star) -> None:
    expect(
        "cancelled, the turtle is back where the star began before the goal is canceled",
        _is_home(star),
        f"The goal is {star.goal.word}, and the turtle {star.gap:.1f} m from where this star began: a "
        "cancel_callback that accepts, and `goal_handle.canceled()` only after the way back, which it drives.",
    )
