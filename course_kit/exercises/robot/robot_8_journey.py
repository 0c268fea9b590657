"""The check of robot-8: an action server that drives the robot to a goal."""

from __future__ import annotations

import math

from geometry_msgs.msg import TwistStamped
from nav2_msgs.action import NavigateToPose

from course_kit.exercises.checker.action_assertions import Client, expect_action
from course_kit.exercises.checker.assertions import answer, chance, expect, nobody_else, require, wait, wait_for_servers
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.examination import current
from course_kit.exercises.checker.robot_fixtures import wait_simulated
from course_kit.exercises.checker.topic_assertions import expect_topic, listen
from course_kit.exercises.checker.wait_for_discovery import meet
from course_kit.exercises.robot.journey_room import Journey, Room
from course_kit.robots.navigation.places import wrapped
from course_kit.ros.observing.received_messages import ReceivedMessages

NEAR, STRAIGHT = 0.1, 0.15  # m and rad, of the text
# What a robot moves besides when tf comes late to its node, on a busy machine: m and rad.
COASTS, SWINGS = 0.05, 0.15
LONGEST, PATIENCE = 50.0, 100.0  # seconds of a journey, where the text says 45; and real ones
OFTEN, RIGHT = 1.6, 0.3  # feedbacks a second, where the text says two; metres
CANCELED = 0.7  # seconds, where the text says 0.5
STANDS = 0.7  # seconds after which a robot that was told to stand does
ELSEWHERE = 0.4  # metres from the robot to where a path begins
CLOSE = 0.6  # metres from what is in its way


@check_of("robot-8")
def drive_there() -> None:
    """It drives to goals by /get_plan and tf, can be cancelled, and stops before what the plan does not know."""
    room = Room()
    nobody_else("rt/cmd_vel")
    answer(threads=None, use_sim_time=True)
    client = expect_action("/navigate_to_pose", NavigateToPose)
    expect_topic("/cmd_vel", TwistStamped)
    commands = listen("/cmd_vel", TwistStamped)
    wait_for_servers(5.0)
    meet(current().test_domain, "/tf", "/tf_static", "/scan")
    wait_simulated(room.robot, 1.0, timeout=10.0)
    arrival = _travel(room, client)
    _expect_arrival(room, arrival)
    _expect_feedback(arrival)
    _expect_cancelled(room, client, commands)
    _expect_stop(room, client)


def _travel(room: Room, client: Client) -> Journey:
    """A whole journey, round a pillar of which the plan knows."""
    journey = room.send(client, room.goal)
    room.follow(journey, LONGEST, PATIENCE)
    require(
        "it accepts a goal, and the goal ends",
        journey.sent.status is not None,
        f"A goal {math.dist(room.goal[:2], journey.start[:2]):.1f} m away is {journey.sent.word} after "
        f"{journey.seconds:.0f} s; the robot is {journey.away:.2f} m from it, and asked `get_plan` {room.asked} times. "
        f"{_wrong_start(room)}If it does not move: is its tick reached, and does tf tell map → base_link? If it turns "
        "for ever: the bearing is atan2(y, x) of the point as the robot sees it, and left is positive.",
    )
    wait_simulated(room.robot, STANDS, timeout=20.0)
    room.look(journey)
    return journey


def _wrong_start(room: Room) -> str:
    """What to say where a path was asked for from somewhere else."""
    if room.start_error < ELSEWHERE:
        return ""
    return (
        f"It asked `get_plan` for a path from {room.start_error:.1f} m beside the robot: look `base_link` up in `map`, "
        "the frame of goal and plan, and not in `odom`. "
    )


def _expect_arrival(room: Room, journey: Journey) -> None:
    """It is where it was sent to, and looks where it should."""
    word, off = journey.sent.word, wrapped(journey.place[2] - journey.goal[2])
    hint = f"{_wrong_start(room)}The goal is {word}, and the robot {journey.away:.2f} m from it"
    if journey.bumps:
        hint += ", after it has bumped into the pillar that the plan leads round"
    elif journey.away_in_odom < NEAR + COASTS < journey.away:
        hint += ", but by `odom` it would be there: look `base_link` up in `map`, the frame of the goal and the plan"
    elif word == "succeeded":
        hint += ": succeed when tf says that base_link is there, and not before; then stand"
    elif word == "aborted":
        hint += (
            ": if it gave up there, does it turn the right way? Left is positive"
            if journey.away < 2 * NEAR
            else ": if it gave up, does it turn to the next point? Its bearing is atan2(y, x), as the robot sees it. "
            "If `execute` has returned without `succeed()`, or raised, that aborts the goal too"
        )
    expect(
        "it is where the goal is, and succeeds",
        word == "succeeded" and journey.away < NEAR + COASTS and not journey.bumps,
        f"{hint}.",
    )
    expect(
        "it looks where the goal looks",
        word == "succeeded" and abs(off) < STRAIGHT + SWINGS,
        f"It should look at {journey.goal[2]:.2f} rad, and looks at {journey.place[2]:.2f}: the heading of a "
        "quaternion is 2 atan2(z, w), in radians; turn by the difference, to the left where it is positive, the "
        "short way round, until it is small.",
    )


def _expect_feedback(journey: Journey) -> None:
    rate = len(journey.sent.feedback) / max(journey.seconds, 0.1)
    told = [feedback.distance_remaining for feedback in journey.sent.feedback]
    said = f"it began with {told[0]:.2f} and ended with {told[-1]:.2f}" if told else "there was none"
    expect(
        "the feedback is the metres that are left",
        rate > OFTEN and journey.wrong_feedback < RIGHT,
        f"`distance_remaining` came {rate:.1f} times a second, {said}; the way was {journey.way:.2f} m, and at the "
        f"median it was {journey.wrong_feedback:.2f} m off. Publish it in each tick, with what is left and not what "
        "is done.",
    )


def _expect_cancelled(room: Room, client: Client, commands: ReceivedMessages) -> None:
    """On the way it is cancelled."""
    simulation = room.robot.simulation
    journey = room.send(client, room.far)
    far = chance().uniform(0.4, 0.8)
    room.follow(journey, 25.0, PATIENCE, lambda: math.dist(journey.start[:2], room.place()[:2]) > far)
    simulation.go_at(min(simulation.factor, 1.0))  # so that a busy machine has as long as the text says
    began = simulation.time
    if journey.sent.accepted and journey.sent.status is None:
        asked = journey.sent.handle.cancel_goal_async()
        wait(lambda: (asked.done() and journey.sent.status is not None) or simulation.time > began + 4.0, 20.0)
    seconds = simulation.time - began
    wait_simulated(room.robot, STANDS, timeout=20.0)
    room.keep_pace()
    last = commands.last.twist if len(commands) else None
    is_zero = last is not None and last.linear.x == last.angular.z == 0.0
    word = journey.sent.word
    hint = f"Cancelled on its way, the goal is {word} after {seconds:.1f} s"
    if word in ("aborted", "succeeded") and not seconds:
        hint = f"It was to be cancelled on its way, and is {word} before"
    elif word != "canceled":
        hint += (
            ": a cancel_callback that accepts, a look at `goal_handle.is_cancel_requested` in each tick, then "
            "`canceled()`. An `execute` that sleeps in a node with one thread hears no request"
        )
    elif not is_zero:
        hint += (
            f", and the last command is {last.linear.x:.2f} m/s, {last.angular.z:.2f} rad/s: the robot goes on until "
            "its watchdog stops it. Publish zeros first"
            if last is not None
            else ""
        )
    expect(
        "cancelled, it is told to stand, and the goal is canceled",
        word == "canceled" and is_zero and seconds < CANCELED,
        f"{hint}.",
    )
    room.follow(journey, LONGEST, PATIENCE)  # if it goes on


def _expect_stop(room: Room, client: Client) -> None:
    """A pillar of which the plan does not know."""
    bumps = room.robot.vehicle.bumps
    journey = room.send(client, room.behind_the_pillar())
    room.follow(journey, LONGEST, PATIENCE)
    word, away = journey.sent.word, room.to_the_pillar()
    bumped = room.robot.vehicle.bumps > bumps
    hint = f"A pillar stands on the path, and the plan does not know it: the goal is {word}, the robot "
    hint += "has bumped into it" if bumped else f"{away:.2f} m from it"
    if bumped:
        hint += ". The scan has the last word: as long as something is in its lane before it, it does not go ahead"
    elif word == "without an end":
        hint += ". When it has not come on for some seconds, `abort()`"
    else:
        hint += ". It should drive up to it, stand, and give up"
    expect(
        "it stops before what the plan does not know, and gives up",
        not bumped and ((word == "succeeded" and journey.away < 2 * NEAR) or (word == "aborted" and away < CLOSE)),
        f"{hint}.",
    )
