"""The buffer of tf2: what it answers, by tf2's documentation and by what users know of it. No traffic.

As tf2_ros it imports course_kit.robots.tf.buffer.
"""

from __future__ import annotations

import math
import subprocess
import sys
import threading
import time as clocks
from collections.abc import Callable
from typing import Any, cast

import numpy as np
import pytest
from pytransform3d.rotations import matrix_from_quaternion
from rclpy.duration import Duration
from rclpy.time import Time
from tf2_ros import (
    Buffer,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

from course_kit.robots.tf.link_history import Link, Sample
from course_kit.robots.tf.rigid_transforms import IDENTITY
from course_kit.ros.causes import cause_of
from tests.transforms import at, place, stamp
from tests.waiting import wait_until

LATEST = Time()
ME = "test"


def filled(*transforms: Any, static: tuple[Any, ...] = ()) -> Buffer:
    buffer = Buffer()
    for one in transforms:
        buffer.set_transform(one, ME)
    for one in static:
        buffer.set_transform_static(one, ME)
    return buffer


class Said:
    """A logger that keeps what it is told."""

    def __init__(self, buffer: Buffer) -> None:
        self.errors: list[str] = []
        self.warnings: list[str] = []
        self.error, self.warning = self.errors.append, self.warnings.append
        buffer.logger = cast(Any, self)


def seconds(value: float) -> Time:
    return Time(nanoseconds=round(value * 1e9))


def moved(**options: Any) -> Buffer:
    """A base that goes 1 m along x from second 10 to second 11, on a map in which odom stands turned."""
    return filled(at("base", "odom", 10.0), at("base", "odom", 11.0, x=1.0), **options)


# What a lookup says


def test_it_is_where_the_source_frame_is_in_the_target_frame() -> None:
    buffer = filled(at("base", "odom", 1.0, x=2.0, y=1.0, yaw=math.pi / 2))
    found = buffer.lookup_transform("odom", "base", LATEST)
    assert (found.header.frame_id, found.child_frame_id) == ("odom", "base")
    assert place(found) == pytest.approx((2.0, 1.0, math.pi / 2))
    assert place(buffer.lookup_transform("base", "odom", LATEST)) == pytest.approx((-1.0, 2.0, -math.pi / 2))


def test_links_are_chained_up_and_down_again() -> None:
    buffer = filled(
        at("odom", "map", 1.0, x=10.0),
        at("base", "odom", 1.0, x=1.0, yaw=math.pi / 2),
        at("laser", "base", 1.0, x=0.5),
        at("camera", "base", 1.0, y=0.2),
    )
    assert place(buffer.lookup_transform("map", "laser", LATEST)) == pytest.approx((11.0, 0.5, math.pi / 2))
    assert place(buffer.lookup_transform("camera", "laser", LATEST)) == pytest.approx((0.5, -0.2, 0.0))


def test_in_space_it_is_the_product_of_the_matrices_of_the_links() -> None:
    chance = np.random.default_rng(7)

    def matrix(message: Any) -> Any:
        shift, turn = message.transform.translation, message.transform.rotation
        result = np.eye(4)
        result[:3, :3] = matrix_from_quaternion([turn.w, turn.x, turn.y, turn.z])
        result[:3, 3] = shift.x, shift.y, shift.z
        return result

    buffer, inside = Buffer(), {"f0": np.eye(4)}
    for number in range(1, 12):
        parent = f"f{chance.integers(number)}"
        one = at(f"f{number}", parent, 5.0)
        shift, turn = one.transform.translation, one.transform.rotation
        shift.x, shift.y, shift.z = chance.normal(size=3).tolist()
        quaternion = chance.normal(size=4)
        turn.x, turn.y, turn.z, turn.w = (quaternion / np.linalg.norm(quaternion)).tolist()
        buffer.set_transform(one, ME)
        inside[f"f{number}"] = inside[parent] @ matrix(one)
    for target, where in inside.items():
        for source, other in inside.items():
            found = matrix(buffer.lookup_transform(target, source, seconds(5.0)))
            assert found == pytest.approx(np.linalg.inv(where) @ other, abs=1e-12)


def test_between_two_samples_it_goes_straight_and_turns_evenly() -> None:
    buffer = filled(at("base", "odom", 10.0), at("base", "odom", 12.0, x=1.0, y=2.0, yaw=math.pi / 2))
    found = buffer.lookup_transform("odom", "base", seconds(10.5))
    assert place(found) == pytest.approx((0.25, 0.5, math.pi / 8))
    assert stamp(found) == 10.5


def test_it_turns_the_shorter_way() -> None:
    buffer = filled(at("base", "odom", 1.0, yaw=math.radians(170)), at("base", "odom", 2.0, yaw=math.radians(190)))
    buffer.set_transform(at("base", "odom", 3.0, yaw=math.radians(-150)), ME)  # 210°, as another quaternion
    for when, degrees in ((1.5, 180), (2.5, 200)):
        yaw = place(buffer.lookup_transform("odom", "base", seconds(when)))[2]
        assert math.remainder(yaw - math.radians(degrees), math.tau) == pytest.approx(0.0, abs=1e-12)


def test_nanoseconds_count() -> None:
    today = 1_790_000_000 * 10**9
    first, second = at("base", "odom", 0.0), at("base", "odom", 0.0, x=100.0)
    first.header.stamp, second.header.stamp = (Time(nanoseconds=today + n).to_msg() for n in (0, 100))
    found = filled(first, second).lookup_transform("odom", "base", Time(nanoseconds=today + 25))
    assert place(found)[0] == pytest.approx(25.0)


def test_the_time_may_be_that_of_a_message() -> None:
    buffer = moved()
    assert place(buffer.lookup_transform("odom", "base", seconds(10.5).to_msg()))[0] == pytest.approx(0.5)


# Which moments there are


def test_after_the_latest_sample_it_would_be_extrapolated() -> None:
    with pytest.raises(ExtrapolationException) as raised:
        moved().lookup_transform("odom", "base", seconds(11.25))
    assert str(raised.value) == (
        "Lookup would require extrapolation into the future.  Requested time 11.250000 but the latest data is at time "
        "11.000000, when looking up transform from frame [base] to frame [odom]"
    )


def test_before_the_oldest_sample_it_would_be_extrapolated() -> None:
    with pytest.raises(ExtrapolationException) as raised:
        moved().lookup_transform("base", "odom", seconds(9.0))
    assert str(raised.value) == (
        "Lookup would require extrapolation into the past.  Requested time 9.000000 but the earliest data is at time "
        "10.000000, when looking up transform from frame [odom] to frame [base]"
    )


@pytest.mark.parametrize("when", [10.0, 11.0])
def test_the_ends_are_known(when: float) -> None:
    assert place(moved().lookup_transform("odom", "base", seconds(when)))[0] == pytest.approx(when - 10)


def test_of_one_sample_only_its_own_moment_is_known() -> None:
    buffer = filled(at("base", "odom", 10.0, x=3.0))
    assert place(buffer.lookup_transform("odom", "base", seconds(10.0)))[0] == 3.0
    with pytest.raises(ExtrapolationException) as raised:
        buffer.lookup_transform("odom", "base", seconds(10.1))
    assert str(raised.value) == (
        "Lookup would require extrapolation at time 10.100000, but only time 10.000000 is in the buffer, "
        "when looking up transform from frame [base] to frame [odom]"
    )
    assert cause_of(raised.value).startswith("Of one of the links one transform has come so far")


def test_time_zero_is_the_latest_moment_that_all_links_know() -> None:
    buffer = moved()
    buffer.set_transform(at("odom", "map", 9.0), ME)
    buffer.set_transform(at("odom", "map", 10.5, x=5.0), ME)
    found = buffer.lookup_transform("map", "base", LATEST)
    assert (stamp(found), place(found)[0]) == (10.5, pytest.approx(5.5))
    assert buffer.get_latest_common_time("map", "base").nanoseconds == 10_500_000_000
    assert stamp(buffer.lookup_transform("odom", "base", LATEST)) == 11.0
    assert stamp(buffer.lookup_transform("base", "base", LATEST)) == 11.0


def test_links_above_both_frames_do_not_matter() -> None:
    buffer = moved(static=(at("laser", "base", 0.0, x=0.1),))
    buffer.set_transform(at("odom", "map", 1.0), ME)
    assert place(buffer.lookup_transform("laser", "odom", seconds(10.5)))[0] == pytest.approx(-0.6)


def test_what_is_static_is_so_at_any_time() -> None:
    buffer = moved(static=(at("laser", "base", 99.0, x=0.1),))
    found = buffer.lookup_transform("base", "laser", seconds(12345.5))
    assert (place(found)[0], stamp(found)) == (pytest.approx(0.1), 12345.5)
    assert stamp(buffer.lookup_transform("base", "laser", LATEST)) == 0.0
    assert place(buffer.lookup_transform("odom", "laser", seconds(10.5)))[0] == pytest.approx(0.6)
    assert stamp(buffer.lookup_transform("odom", "laser", LATEST)) == 11.0


def test_a_link_becomes_static_and_moves_again() -> None:
    buffer = moved()
    buffer.set_transform_static(at("base", "odom", 0.0, x=7.0), ME)
    assert place(buffer.lookup_transform("odom", "base", seconds(50.0)))[0] == 7.0
    buffer.set_transform(at("base", "odom", 20.0, x=8.0), ME)
    assert place(buffer.lookup_transform("odom", "base", LATEST))[0] == 8.0
    assert not buffer.can_transform("odom", "base", seconds(10.5))


def test_a_frame_in_itself_is_there_even_if_nobody_knows_it() -> None:
    found = Buffer().lookup_transform("nowhere", "nowhere", seconds(3.0))
    assert (place(found), stamp(found)) == ((0.0, 0.0, 0.0), 3.0)


def test_between_two_moments_a_fixed_frame_stands_still() -> None:
    buffer = moved()
    found = buffer.lookup_transform_full("base", seconds(11.0), "base", seconds(10.0), "odom")
    assert (place(found)[0], stamp(found)) == (pytest.approx(-1.0), 11.0)
    assert buffer.can_transform_full("base", seconds(11.0), "base", seconds(10.0), "odom")
    assert not buffer.can_transform_full("base", seconds(12.0), "base", seconds(10.0), "odom")
    with pytest.raises(ExtrapolationException, match="into the future"):
        buffer.lookup_transform_full("base", seconds(12.0), "base", seconds(10.0), "odom")


# Which ways there are


def test_a_frame_that_nobody_knows_is_named() -> None:
    buffer = moved()
    for target, source, role in (("map", "base", "target"), ("odom", "laser", "source")):
        with pytest.raises(LookupException) as raised:
            buffer.lookup_transform(target, source, LATEST)
        name = target if role == "target" else source
        assert str(raised.value) == f'"{name}" passed to lookupTransform argument {role}_frame does not exist. '


@pytest.mark.parametrize(
    ("name", "why"), [("", "cannot be empty"), ("/odom", "cannot start with a '/'")], ids=["empty", "slash"]
)
def test_what_is_no_name_is_refused(name: str, why: str) -> None:
    with pytest.raises(InvalidArgumentException) as raised:
        moved().lookup_transform(name, "base", LATEST)
    said = f'Invalid argument "{name}" passed to lookupTransform argument target_frame - in tf2 frame_ids {why}'
    assert str(raised.value) == said


def test_a_slash_before_a_name_is_dropped_where_it_is_told() -> None:
    buffer = filled(at("/base", "/odom", 1.0, x=1.0))
    assert place(buffer.lookup_transform("odom", "base", LATEST))[0] == 1.0


def test_two_trees_are_told() -> None:
    buffer = filled(at("base", "odom", 1.0), at("laser", "mast", 1.0))
    for when in (LATEST, seconds(1.0)):
        with pytest.raises(ConnectivityException) as raised:
            buffer.lookup_transform("odom", "laser", when)
        assert str(raised.value) == (
            "Could not find a connection between 'odom' and 'laser' because they are not part of the same tree."
            "Tf has two or more unconnected trees."
        )
    with pytest.raises(TransformException, match="not part of the same tree"):
        buffer.get_latest_common_time("odom", "laser")


def test_a_loop_is_told() -> None:
    buffer = filled(at("a", "b", 1.0), at("b", "c", 1.0), at("c", "a", 1.0), at("d", "e", 1.0))
    for when in (LATEST, seconds(1.0)):
        with pytest.raises(LookupException, match=r"The tf tree is invalid because it contains a loop\.\nFrame a"):
            buffer.lookup_transform("d", "a", when)


def test_a_new_parent_counts_from_its_first_sample() -> None:
    buffer = filled(at("cup", "table", 1.0), at("cup", "table", 2.0, x=1.0), at("hand", "table", 1.0))
    buffer.set_transform(at("hand", "table", 9.0), ME)
    for when in (3.0, 4.0):
        buffer.set_transform(at("cup", "hand", when, x=0.5), ME)
    assert place(buffer.lookup_transform("table", "cup", seconds(1.5)))[0] == pytest.approx(0.5)
    # Between parents nothing is interpolated: the older sample holds.
    assert place(buffer.lookup_transform("table", "cup", seconds(2.5)))[0] == pytest.approx(1.0)
    assert place(buffer.lookup_transform("hand", "cup", seconds(3.5)))[0] == pytest.approx(0.5)


# Whether there is one, and why not


def test_can_transform_says_why_not() -> None:
    buffer = moved()
    buffer.set_transform(at("laser", "mast", 1.0), ME)
    asked: dict[tuple[str, str, float], str] = {
        ("odom", "base", 10.5): "",
        ("base", "base", 99.0): "",
        ("odom", "nix", 10.5): 'Invalid frame ID "nix" passed to canTransform argument source_frame - '
        "frame does not exist",
        ("/odom", "base", 10.5): 'Invalid frame ID "/odom" passed to canTransform argument target_frame - '
        "in tf2 frame_ids cannot start with a '/'",
        ("odom", "base", 12.0): "Lookup would require extrapolation into the future.  Requested time 12.000000 but "
        "the latest data is at time 11.000000, when looking up transform from frame [base] to frame [odom]",
        ("odom", "laser", 1.0): "Could not find a connection between 'odom' and 'laser' because they are not part of "
        "the same tree.Tf has two or more unconnected trees.",
    }
    for (target, source, when), why in asked.items():
        assert buffer.can_transform(target, source, seconds(when), return_debug_tuple=True) == (not why, why)
        assert bool(buffer.can_transform(target, source, seconds(when))) is not bool(why)


def test_the_exceptions_are_those_of_tf2() -> None:
    kinds = (LookupException, ConnectivityException, ExtrapolationException, InvalidArgumentException, TimeoutException)
    assert all(issubclass(kind, TransformException) and kind.__module__ == "tf2" for kind in kinds)
    assert TransformException.__bases__ == (Exception,)


@pytest.mark.parametrize("wrong", [0, 1.5, None])
def test_a_time_that_is_none_is_refused_with_the_cure(wrong: Any) -> None:
    with pytest.raises(TypeError, match=r"time must have sec and nanosec, or nanoseconds.*rclpy\.time\.Time\(\)"):
        moved().lookup_transform("odom", "base", wrong)
    with pytest.raises(TypeError, match=r"timeout must have .*rclpy\.duration\.Duration"):
        moved().lookup_transform("odom", "base", LATEST, wrong)


def test_a_frame_is_named_by_a_text() -> None:
    unnamed: Any = None
    with pytest.raises(TypeError, match="a frame is named by a text, not by None"):
        moved().lookup_transform(unnamed, "base", LATEST)


# What is taken in


def test_what_is_older_than_all_that_is_kept_is_ignored_with_a_warning() -> None:
    buffer = filled(at("base", "odom", 100.0, x=1.0))
    said = Said(buffer)
    buffer.set_transform(at("base", "odom", 89.9), ME)
    buffer.set_transform(at("base", "odom", 95.0), ME)
    assert buffer.can_transform("odom", "base", seconds(97.0))
    assert not buffer.can_transform("odom", "base", seconds(90.0))
    assert said.warnings == [
        "TF_OLD_DATA ignoring data from the past for frame base at time 89.900000 according to authority test\n"
        "Possible reasons are listed at http://wiki.ros.org/tf/Errors%20explained"
    ]


def _spoilt(change: Callable[[Any], None]) -> Any:
    message = at("base", "odom", 1.0)
    change(message)
    return message


def _unset_child(message: Any) -> None:
    message.child_frame_id = ""


def _unset_parent(message: Any) -> None:
    message.header.frame_id = ""


def _own_parent(message: Any) -> None:
    message.header.frame_id = "base"


def _nan(message: Any) -> None:
    message.transform.translation.y = math.nan


def _no_rotation(message: Any) -> None:
    message.transform.rotation.w = 0.0


def _too_long(message: Any) -> None:
    message.transform.rotation.w = 1.01


@pytest.mark.parametrize(
    ("change", "line"),
    [
        (_unset_child, "TF_NO_CHILD_FRAME_ID: Ignoring transform"),
        (_unset_parent, "TF_NO_FRAME_ID: Ignoring transform"),
        (_own_parent, "TF_SELF_TRANSFORM: Ignoring transform"),
        (_nan, 'TF_NAN_INPUT: Ignoring transform for child_frame_id "base" from authority "test"'),
        (_no_rotation, "TF_DENORMALIZED_QUATERNION: Ignoring transform"),
        (_too_long, "invalid quaternion in the transform (0.000000 0.000000 0.000000 1.010000)"),
    ],
)
def test_what_makes_no_sense_is_ignored_with_an_error(change: Callable[[Any], None], line: str) -> None:
    for tell in (Buffer.set_transform, Buffer.set_transform_static):
        buffer = Buffer()
        said = Said(buffer)
        tell(buffer, _spoilt(change), ME)
        assert buffer.all_frames_as_yaml() == "[]"
        assert line in said.errors[0]


def test_a_quaternion_that_is_nearly_one_is_taken() -> None:
    message = at("base", "odom", 1.0)
    message.transform.rotation.w = 1.004
    assert place(filled(message).lookup_transform("odom", "base", LATEST))[2] == 0.0


def test_the_order_in_which_samples_come_does_not_matter() -> None:
    buffer = filled(*(at("base", "odom", when, x=when) for when in (3.0, 1.0, 2.0, 4.0)))
    for when in (1.0, 1.5, 2.25, 3.75):
        assert place(buffer.lookup_transform("odom", "base", seconds(when)))[0] == pytest.approx(when)


def test_of_two_samples_of_one_moment_the_later_holds_and_the_same_one_counts_once() -> None:
    buffer = filled(at("base", "odom", 1.0, x=1.0), at("base", "odom", 1.0, x=2.0), at("base", "odom", 1.0, x=2.0))
    assert place(buffer.lookup_transform("odom", "base", seconds(1.0)))[0] == 2.0
    assert "rate: 20000.000" in buffer.all_frames_as_yaml()


def test_ten_seconds_are_kept_or_what_is_asked_for() -> None:
    for cache_time, kept in ((None, 10.0), (Duration(seconds=2), 2.0)):
        buffer = Buffer(cache_time)
        for tenths in range(1, 301):
            buffer.set_transform(at("base", "odom", tenths * 0.1), ME)
        assert buffer.can_transform("odom", "base", seconds(30.0 - kept))
        assert not buffer.can_transform("odom", "base", seconds(30.0 - kept - 0.2))


def test_it_does_not_grow_in_hours() -> None:
    link = Link(10 * 10**9, is_static=False)
    for hundredths in range(1, 360_001):  # an hour at 100 Hz
        assert link.add(Sample(hundredths * 10**7, "odom", IDENTITY))
        if hundredths == 5000:
            assert len(link) <= 1002
    assert len(link) <= 1002


def test_clearing_forgets_what_has_moved_and_keeps_what_is_static() -> None:
    buffer = moved(static=(at("laser", "base", 0.0, x=0.1),))
    buffer.clear()
    assert place(buffer.lookup_transform("base", "laser", seconds(1.0)))[0] == pytest.approx(0.1)
    with pytest.raises(ConnectivityException):
        buffer.lookup_transform("odom", "base", LATEST)
    with pytest.raises(ExtrapolationException):
        buffer.lookup_transform("odom", "base", seconds(10.5))
    buffer.set_transform(at("base", "odom", 1.0), ME)  # older than what was there
    assert buffer.can_transform("odom", "laser", seconds(1.0))


def test_all_frames_as_text() -> None:
    buffer = moved(static=(at("laser", "base", 0.0),))
    assert (
        buffer.all_frames_as_string() == "Frame base exists with parent odom.\nFrame laser exists with parent base.\n"
    )
    assert buffer.all_frames_as_yaml() == (
        "base: \n  parent: 'odom'\n  broadcaster: 'test'\n  rate: 2.000\n  most_recent_transform: 11.000000\n"
        "  oldest_transform: 10.000000\n  buffer_length: 1.000\n"
        "laser: \n  parent: 'base'\n  broadcaster: 'test'\n  rate: 10000.000\n  most_recent_transform: 0.000000\n"
        "  oldest_transform: 0.000000\n  buffer_length: 0.000\n"
    )


# Waiting


def test_a_lookup_waits_for_what_another_thread_puts_in() -> None:
    buffer = moved()
    later = threading.Timer(0.05, lambda: buffer.set_transform(at("base", "odom", 12.0, x=2.0), ME))
    later.start()
    found = buffer.lookup_transform("odom", "base", seconds(11.5), Duration(seconds=20))
    assert place(found)[0] == pytest.approx(1.5)
    later.join()


def test_a_lookup_that_waits_in_vain_says_what_is_missing() -> None:
    began = clocks.monotonic()
    with pytest.raises(ExtrapolationException, match="into the future"):
        moved().lookup_transform("odom", "base", seconds(11.5), Duration(seconds=0.1))
    assert clocks.monotonic() - began >= 0.1
    assert not moved().can_transform("odom", "base", seconds(11.5), Duration(seconds=0.02))


def test_a_future_is_done_when_the_transform_is_there() -> None:
    buffer = moved()
    there = buffer.wait_for_transform_async("odom", "base", seconds(10.5))
    awaited = buffer.wait_for_transform_async("odom", "base", seconds(11.5))
    full = buffer.wait_for_transform_full_async("base", seconds(12.0), "base", seconds(10.0), "odom")
    unwanted = buffer.wait_for_transform_async("odom", "base", seconds(11.5))
    assert there.done() and not awaited.done()
    assert place(there.result())[0] == pytest.approx(0.5)
    unwanted.cancel()
    buffer.set_transform(at("elsewhere", "odom", 12.0), ME)
    assert not awaited.done()
    buffer.set_transform(at("base", "odom", 12.0, x=2.0), ME)
    assert place(awaited.result())[0] == pytest.approx(1.5)
    assert place(full.result())[0] == pytest.approx(-2.0)
    assert unwanted.cancelled()


def test_threads_may_ask_while_others_tell() -> None:
    buffer, problems, ended = moved(), [], threading.Event()

    def ask() -> None:
        while not ended.is_set():
            try:
                found = buffer.lookup_transform("odom", "laser", LATEST)
                if place(found)[0] != pytest.approx(stamp(found) - 10 + 0.1, abs=1e-6):
                    problems.append(found)
            except Exception as error:
                problems.append(error)

    buffer.set_transform_static(at("laser", "base", 0.0, x=0.1), ME)
    askers = [threading.Thread(target=ask) for _ in range(3)]
    for one in askers:
        one.start()
    for hundredths in range(1, 2001):
        buffer.set_transform(at("base", "odom", 11 + hundredths * 0.01, x=1 + hundredths * 0.01), ME)
    ended.set()
    for one in askers:
        one.join()
    assert problems == []
    wait_until(lambda: not any(one.is_alive() for one in askers))


def test_importing_it_is_quick() -> None:
    heavy = ("scipy", "pytransform3d", "matplotlib", "nav_msgs", "sensor_msgs")
    code = f"import sys, tf2_ros; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
