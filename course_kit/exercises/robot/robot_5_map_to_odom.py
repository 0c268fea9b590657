"""The check of robot-5: the transform from map to odom."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped, TransformStamped
from tf2_msgs.msg import TFMessage

from course_kit.exercises.checker.assertions import answer, chance, expect, pause, require, wait
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.topic_assertions import (
    expect_compatible_subscription,
    expect_subscription,
    expect_topic,
    listen,
    publisher,
)
from course_kit.robots.navigation.messages import place_of, stamped_pose, transform_of
from course_kit.robots.navigation.places import Place, after, between, inverse, wrapped
from course_kit.ros.observing.received_messages import ReceivedMessages

TICK = 0.02  # seconds from odom → base_link to the next
TICKS_A_POSE = 10
LATE = 10  # ticks by which a pose comes later than the odometry of its moment
ANSWERED = 0.5  # seconds until all that is still to come is there,
LATEST = 3.0  # and so many before it, on a busy machine, until one for the last pose is there
NEAR = 0.03  # m and rad; the numbers are exact
MOST = 0.8  # of the transforms that must fit: a machine that is busy may hold one back until the next pose
# What comes of a heading that is sent as degrees, as the quaternion (z=heading, w=1), or as (z=heading/2, w=1).
MISTAKEN_TURNS = (math.degrees, lambda heading: 2 * math.atan(heading), lambda heading: 2 * math.atan(heading / 2))
AHEAD = 1.0  # seconds by which a transform may be stamped ahead


@dataclass
class Told:
    """What the answer told in one part of the drive, and what would be right."""

    transforms: list[TransformStamped]
    odom: Place  # in the map
    poses: list[tuple[Place, Place]]  # of base_link in the map, and in odom at the same moment
    stamps: list[float]  # of the poses, s
    end: float = math.inf  # when its time was over, s

    def fits(self) -> bool:
        """Return True if nearly all of them put odom in its place; the first may come before the part's first pose."""
        right = [_is_near(place_of(one.transform), self.odom) for one in self.transforms]
        return sum(right) >= MOST * len(right) - 1 and sum(right) >= len(self.poses) / 2

    def wrong(self) -> TransformStamped | None:
        """One in the middle that does not fit."""
        wrong = [one for one in self.transforms if not _is_near(place_of(one.transform), self.odom)]
        return wrong[len(wrong) // 2] if wrong else None


class Drive:
    """A robot that only says where it is: by odometry on /tf, and a little later on the map, on /pose_on_map."""

    def __init__(self, heard: ReceivedMessages) -> None:
        self._heard = heard
        self._tf = publisher("/tf", TFMessage, 100)
        self._pose = publisher("/pose_on_map", PoseStamped)
        self._place: Place = (chance().uniform(-3, 3), chance().uniform(-3, 3), chance().uniform(-3, 3))
        for topic, end in (("/tf", self._tf), ("/pose_on_map", self._pose)):
            expect_compatible_subscription(topic, end)

    def part(self, odom: Place, speed: float, turning: float, seconds: float) -> Told:
        """Drive for a while (m/s, rad/s) with odom at this place in the map."""
        before, past = len(self._heard), []
        told = Told([], odom, [], [])
        for tick in range(round(seconds / TICK)):
            self._place = after(self._place, (speed * TICK, 0.0, turning * TICK))
            stamp = _stamp(time.time())
            self._tf.publish(TFMessage(transforms=[transform_of(self._place, "odom", "base_link", stamp)]))
            past.append((stamp, self._place))
            if tick >= LATE and tick % TICKS_A_POSE == 0:
                stamp, place = past[-LATE]
                on_map = after(odom, place)
                self._pose.publish(stamped_pose(on_map, "map", stamp))
                told.poses.append((on_map, place))
                told.stamps.append(_seconds(stamp))
            pause(TICK)
        wait(lambda: any(_seconds(one.header.stamp) >= told.stamps[-1] for one in self._since(before)), LATEST)
        pause(ANSWERED)
        told.transforms, told.end = self._since(before), time.time()
        return told

    def _since(self, before: int) -> list[TransformStamped]:
        return [one for message in self._heard.messages[before:] for one in message.transforms]


@check_of("robot-5")
def map_to_odom() -> None:
    """It tells tf where odom lies in the map, so that base_link is where /pose_on_map says."""
    answer()
    expect_subscription("/pose_on_map", PoseStamped)
    expect_subscription("/tf", TFMessage)
    expect_topic("/tf", TFMessage)
    drive = Drive(listen("/tf", TFMessage))
    here, there = (_drawn_place() for _ in range(2))
    side = chance().choice((1, -1))
    rest = drive.part(here, 0.0, 0.0, 1.6)
    moving = drive.part(here, chance().uniform(1.0, 1.5), side * chance().uniform(0.6, 1.0), 2.4)
    corrected = drive.part(there, chance().uniform(0.3, 0.6), -side * chance().uniform(0.6, 1.0), 2.4)
    parts = rest, moving, corrected
    require(
        "it broadcasts when a pose comes",
        any(part.transforms for part in parts),
        "Nothing of yours came on /tf. Poses come on /pose_on_map, each 0.2 s after the odometry of its moment: "
        "compute in its callback, and send with TransformBroadcaster.",
    )
    _expect_frames(parts)
    wrong = rest.wrong()
    expect("the robot stands: base_link is where the pose says", rest.fits(), _why(rest, wrong))
    hint = _why(moving, moving.wrong())
    if rest.fits() and not moving.fits():
        hint = (
            f"It was right while the robot stood. Driving, odom is {_off(moving):.2f} m off: the pose is of the moment "
            "in its header, 0.2 s ago, and your odom → base_link is of another one. Look it up at that time: "
            "`lookup_transform('odom', 'base_link', Time.from_msg(pose.header.stamp))`."
        )
    expect("it drives: odometry is taken at the pose's stamp", moving.fits(), hint)
    hint = _why(corrected, corrected.wrong())
    if moving.fits() and not corrected.fits():
        hint = (
            f"Then the poses said that odom lies elsewhere, and it did not follow: compute anew for each pose. {hint}"
        )
    expect("the estimate changes: odom moves in the map", corrected.fits(), hint)


def _drawn_place() -> Place:
    """A place so far from the origin, and turned so much, that no mistake looks right."""
    signs = [chance().choice((1, -1)) for _ in range(3)]
    x, y, heading = chance().uniform(1.5, 4), chance().uniform(1.5, 4), 0.0
    while any(abs(wrapped(turn(heading) - heading)) < 3 * NEAR for turn in MISTAKEN_TURNS):
        heading = chance().uniform(0.6, 2.4)
    return signs[0] * x, signs[1] * y, signs[2] * heading


def _expect_frames(parts: tuple[Told, ...]) -> None:
    """All transforms say map → odom, at times at which one can use them."""
    transforms = [one for part in parts for one in part.transforms]
    links = sorted({f"{one.header.frame_id} → {one.child_frame_id}" for one in transforms})
    hint = f"Your node tells {', '.join(links)}. "
    if any(one.child_frame_id == "base_link" for one in transforms):
        hint += (
            "base_link has a parent already, odom: a frame has one only, so tf would jump from one to the other. "
            "What may be corrected is where odom lies in the map."
        )
    elif links == ["odom → map"]:
        hint += "The header has the parent, map, and child_frame_id is odom: a tree has one root, the map."
    else:
        hint += "The header's frame_id is map, child_frame_id is odom, without a slash."
    stamped, usable = _stamps(parts)
    if links == ["map → odom"]:
        hint = (
            f"One is stamped {stamped}, so tf would not find it for that moment. The stamp is that of the pose, or up "
            "to 1 s later: `transform.header.stamp = pose.header.stamp`."
        )
    expect("it tells map → odom, at the time of each pose", links == ["map → odom"] and usable, hint, needed=True)


def _stamps(parts: tuple[Told, ...]) -> tuple[str, bool]:
    """A stamp that is before all poses with odom at its place or too far ahead, in words; and whether there is none.

    Two parts have odom at one place: a transform that is sent at the end of the first one may come in the second.
    """
    first: dict[Place, float] = {}  # by odom's place, when the first pose was
    for part in parts:
        known = first.setdefault(part.odom, part.stamps[0])
        for one in part.transforms[1:]:
            stamp = _seconds(one.header.stamp)
            if stamp < known - 1e-6 and _is_near(place_of(one.transform), part.odom):
                return ("0" if stamp == 0 else f"{known - stamp:.1f} s before its pose"), False
            if stamp > part.end + AHEAD:
                return f"{stamp - part.stamps[0]:.1f} s after its pose", False
    return "", True


def _why(part: Told, wrong: TransformStamped | None) -> str:
    """What a wrong transform is, as far as it can be told."""
    if wrong is None:
        return f"{len(part.transforms)} transforms came for {len(part.poses)} poses: one for each."
    sent, q = place_of(wrong.transform), wrong.transform.rotation
    said = f"For {_shown(part.odom)} it said {_shown(sent)}. "
    if _is_near(sent[:2], part.odom[:2]):
        norm = math.sqrt(q.x**2 + q.y**2 + q.z**2 + q.w**2)
        return (
            f"{said}x and y are right, the heading is not; its quaternion is z={q.z:.2f}, w={q.w:.2f}, of length "
            f"{norm:.2f}. A turn by an angle in radians has z=sin(angle/2) and w=cos(angle/2)."
        )
    causes = {
        "that is no turn and no way: odometry taken for truth": lambda pose, place: (0.0, 0.0, 0.0),
        "that is the pose, base_link in the map; asked is odom in the map, after(pose, inverse(odometry))": (
            lambda pose, place: pose
        ),
        "that is the map seen from odom: the inverse of what is asked": lambda pose, place: inverse(part.odom),
        "that is the pose after odometry: the inverse is missing": after,
        "the order is wrong: first the pose, then back along odometry": lambda pose, place: between(place, pose),
        "x and y are subtracted each for itself, as if the map were not turned: a way is turned by the heading": (
            lambda pose, place: tuple(a - b for a, b in zip(pose, place, strict=True))
        ),
    }
    for cause, place_by in causes.items():
        if any(_is_near(sent[:2], place_by(pose, place)[:2]) for pose, place in part.poses):
            return f"{said}So {cause}."
    return f"{said}map → odom is after(pose, inverse(odometry)), with odom → base_link at the pose's stamp, in radians."


def _off(part: Told) -> float:
    """Metres by which the middle one of its wrong transforms is off, at the robot."""
    wrong = part.wrong()
    if wrong is None:
        return 0.0
    pose, place = part.poses[len(part.poses) // 2]
    return math.dist(after(place_of(wrong.transform), place)[:2], pose[:2])


def _is_near(one: Any, other: Any) -> bool:
    off = [a - b for a, b in zip(one, other, strict=True)]
    return math.hypot(*off[:2]) < NEAR and all(abs(wrapped(angle)) < NEAR for angle in off[2:])


def _shown(place: Place) -> str:
    return f"x={place[0]:.2f}, y={place[1]:.2f}, heading {place[2]:.2f} rad"


def _stamp(seconds: float) -> Time:
    return Time(sec=int(seconds), nanosec=int(seconds % 1 * 1e9))


def _seconds(stamp: Time) -> float:
    return float(stamp.sec + stamp.nanosec * 1e-9)
