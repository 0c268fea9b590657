"""The check of robot-6: particles drawn anew by their weights."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from geometry_msgs.msg import PoseArray, PoseStamped
from std_msgs.msg import Float64MultiArray, MultiArrayDimension

from course_kit.exercises.checker.assertions import answer, chance, expect, require, wait
from course_kit.exercises.checker.checks import check_of
from course_kit.exercises.checker.topic_assertions import (
    expect_compatible_subscription,
    expect_subscription,
    expect_topic,
    listen,
    publisher,
)
from course_kit.robots.navigation.messages import place_of
from course_kit.robots.navigation.places import Place, wrapped
from course_kit.ros.observing.received_messages import ReceivedMessages

Floats = npt.NDArray[np.float64]
ANSWER = 6.0  # seconds
SAME = 1e-4  # m and rad: a copy is the particle
ROUNDED = 1e-6  # of a copy
NEAR = 0.01  # m and rad of the estimate
SERVINGS = 36  # of the same cloud, to see whether chance is in it
FAIR = 0.42  # copies by which the mean of so many may be off: five times its standard deviation


@dataclass
class Drawn:
    """What came back for one cloud."""

    cloud: Floats  # x, y, heading, weight of each particle
    poses: list[Place]
    estimates: list[Place]
    frames: list[str]  # of both messages

    @property
    def wanted(self) -> Floats:
        """How many copies of each particle there should be, on average."""
        weights = self.cloud[:, 3]
        return np.asarray(len(weights) * weights / weights.sum())

    def copies(self) -> Floats:
        """How many copies of each particle came."""
        counts = np.zeros(len(self.cloud))
        for pose in self.poses:
            counts[self._nearest(pose)] += 1
        return counts

    def _nearest(self, pose: Place) -> int:
        return int(np.argmin(np.hypot(*(self.cloud[:, :2] - np.array(pose[:2])).T)))

    def strangers(self) -> list[Place]:
        """The poses that are no particle's."""
        return [pose for pose in self.poses if not _is_same(pose, self.cloud[self._nearest(pose)], SAME)]

    def mean(self) -> Place:
        """The mean of the particles by weight."""
        x, y, heading, weight = self.cloud.T
        sine, cosine = weight @ np.sin(heading), weight @ np.cos(heading)
        return float(weight @ x / weight.sum()), float(weight @ y / weight.sum()), math.atan2(sine, cosine)


@check_of("robot-6")
def resample() -> None:
    """It draws particles anew by weight, the low-variance way, and says where the robot is."""
    answer()
    expect_subscription("/particles", Float64MultiArray)
    expect_topic("/resampled", PoseArray)
    expect_topic("/estimate", PoseStamped)
    sender = publisher("/particles", Float64MultiArray)
    expect_compatible_subscription("/particles", sender)
    heard = listen("/resampled", PoseArray), listen("/estimate", PoseStamped)
    silent: set[ReceivedMessages] = set()

    def draw(cloud: Floats) -> Drawn:
        before = {one: len(one) for one in heard}

        def missing() -> set[ReceivedMessages]:
            return {one for one in heard if len(one) == before[one]} - silent

        sender.publish(_message(cloud))
        wait(lambda: not missing(), ANSWER, "an answer")
        silent.update(missing())  # they are waited for once
        new = [one.messages[b : b + 1] for one, b in before.items()]
        frames = [message.header.frame_id for messages in new for message in messages]
        return Drawn(cloud, _places(new[0]), _places(new[1]), frames)

    drawn = [draw(_cloud(chance().randint(150, 350))) for _ in range(3)]
    hint = (
        f"Nothing came on /resampled within {ANSWER:g} s after a message on /particles: publish both in its callback."
    )
    require("new particles come", any(one.poses for one in drawn), hint)
    _expect_particles(drawn)
    few = _cloud(40)
    served = [draw(few) for _ in range(SERVINGS)]
    is_low = _expect_copies([*drawn, *served])
    wanted = served[0].wanted
    off = np.mean([one.copies() for one in served], axis=0) - wanted
    # Who draws each particle for itself is as fair, but not as steady.
    bound = np.full(len(wanted), FAIR) if is_low else np.maximum(FAIR, 5 * np.sqrt(wanted / SERVINGS))
    worst = int((np.abs(off) / bound).argmax())
    expect(
        "each survives as often as its weight says, by chance",
        abs(off[worst]) < bound[worst],
        f"The same 40 particles came {SERVINGS} times. One that should have {wanted[worst]:.2f} copies on "
        f"average had {wanted[worst] + off[worst]:.2f}. Where the marks begin is drawn anew each time: "
        "`(np.arange(n) + random.uniform()) / n`, with one number for all marks.",
    )
    _expect_estimates(drawn)


def _cloud(count: int) -> Floats:
    """Particles that look about west, with weights that do not add up to 1, some of them 0."""
    random = np.random.default_rng(chance().randrange(2**32))
    middle = random.uniform(-5, 5, 2)
    west = np.array([wrapped(one + math.pi) for one in random.normal(random.uniform(-0.2, 0.2), 0.5, count)])
    weights = random.exponential(1.0, count) ** 2 * (random.random(count) > 0.1)
    weights *= random.uniform(5.0, 50.0) / weights.sum()
    return np.column_stack([random.normal(middle, 0.5, (count, 2)), west, weights])


def _message(cloud: Floats) -> Float64MultiArray:
    message = Float64MultiArray(data=cloud.ravel().tolist())
    rows, columns = cloud.shape
    message.layout.dim = [
        MultiArrayDimension(label="particles", size=rows, stride=rows * columns),
        MultiArrayDimension(label="x y heading weight", size=columns, stride=columns),
    ]
    return message


def _places(messages: list[Any]) -> list[Place]:
    """The poses of messages of either type."""
    poses = [pose for message in messages for pose in getattr(message, "poses", None) or [message.pose]]
    return [place_of(pose) for pose in poses]


def _is_same(one: Place | Floats, other: Place | Floats, near: float) -> bool:
    off = [float(a - b) for a, b in zip(one[:3], other[:3], strict=True)]
    return math.hypot(off[0], off[1]) < near and abs(wrapped(off[2])) < near


def _expect_particles(drawn: list[Drawn]) -> None:
    wrong = next((one for one in drawn if len(one.poses) != len(one.cloud) or one.strangers()), drawn[0])
    strangers = wrong.strangers()
    hint = f"{len(wrong.cloud)} particles came, and your node published {len(wrong.poses)} poses: as many as came. "
    if strangers and len(wrong.poses) == len(wrong.cloud):
        pose = strangers[0]
        hint = (
            f"The pose x={pose[0]:.2f}, y={pose[1]:.2f}, heading {pose[2]:.2f} rad is no particle's, as are "
            f"{len(strangers)} of {len(wrong.poses)}. Copies are exact; a heading as quaternion is z=sin(heading/2), "
            "w=cos(heading/2), in radians."
        )
    is_right = len(wrong.poses) == len(wrong.cloud) and not strangers
    expect("as many particles as came, and each is one of them", is_right, hint, needed=True)


def _expect_copies(drawn: list[Drawn]) -> bool:
    """Nobody has a copy too many or too few; whether that holds."""
    off = [np.abs(one.copies() - one.wanted) for one in drawn]
    worst = max(range(len(drawn)), key=lambda number: off[number].max())
    one, index = drawn[worst], int(off[worst].argmax())
    copies, wanted = one.copies(), one.wanted
    hint = f"Of {len(copies)} particles, one that should have {wanted[index]:.2f} copies has {copies[index]:.0f}. "
    if (copies == 1).all():
        hint += "They are the particles that came: draw by weight, then all weigh the same."
    elif copies.max() == len(copies):
        hint += "All are copies of one: the best guess may be wrong, so others must live on, as many as they weigh."
    else:
        hint += (
            "With a draw for each particle (`random.choice`) a good one may die by bad luck. The low-variance way "
            "draws once: marks at equal distances along the sum of the weights, which is not 1 here: "
            "`np.searchsorted(np.cumsum(weights) / weights.sum(), marks)`."
        )
    return expect("copies by weight, none more than one too many or too few", off[worst].max() < 1 + ROUNDED, hint)


def _expect_estimates(drawn: list[Drawn]) -> None:
    wrong = next((one for one in drawn if not one.estimates or not _is_same(one.estimates[0], one.mean(), NEAR)), None)
    frames = sorted({frame for one in drawn for frame in one.frames})
    hint = "Nothing came on /estimate: publish it with /resampled."
    if not wrong:
        hint = f"The frame_id of the headers is {frames}: poses without their frame, map, mean nothing to anybody."
    if wrong and wrong.estimates:
        said, mean = wrong.estimates[0], wrong.mean()
        hint = f"It said x={said[0]:.2f}, y={said[1]:.2f}, heading {said[2]:.2f} rad, and the mean by weight is "
        hint += f"x={mean[0]:.2f}, y={mean[1]:.2f}, heading {mean[2]:.2f} rad. "
        if _is_same((*said[:2], 0.0), (*mean[:2], 0.0), NEAR):
            hint += "The mean of 179° and -179° is not 0°: add sines and cosines by weight, then `math.atan2`."
        else:
            hint += "Weights do not add up to 1 here: divide by their sum."
    expect("the estimate is their mean by weight, the heading's too, in `map`", not wrong and frames == ["map"], hint)
