"""Transforms that tf2 does not take in, and what it says of each. No ROS."""

from __future__ import annotations

import math

from course_kit.robots.tf.link_history import Sample, seconds

TOLERANCE = 0.01  # of the square of a quaternion's length
EXPLAINED = "Possible reasons are listed at http://wiki.ros.org/tf/Errors%20explained"


def refusals(child: str, sample: Sample, authority: str) -> list[str]:
    """What makes no sense in where a frame is said to be: a line each."""
    said: list[str] = []
    numbers = [*sample.placement.translation, *_xyzw(sample)]
    if child == sample.parent:
        said.append(
            f'TF_SELF_TRANSFORM: Ignoring transform from authority "{authority}" with frame_id and  '
            f'child_frame_id "{child}" because they are the same'
        )
    if not child:
        said.append(
            f'TF_NO_CHILD_FRAME_ID: Ignoring transform from authority "{authority}" because child_frame_id not set '
        )
    if not sample.parent:
        said.append(
            f'TF_NO_FRAME_ID: Ignoring transform with child_frame_id "{child}"  from authority "{authority}" '
            "because frame_id not set"
        )
    if any(map(math.isnan, numbers)):
        said.append(
            f'TF_NAN_INPUT: Ignoring transform for child_frame_id "{child}" from authority "{authority}" because of '
            f"a nan value in the transform {_shown(numbers[:3])} {_shown(numbers[3:])}"
        )
    if not abs(sum(part * part for part in numbers[3:]) - 1) < TOLERANCE:
        said.append(
            f'TF_DENORMALIZED_QUATERNION: Ignoring transform for child_frame_id "{child}" from authority '
            f'"{authority}" because of an invalid quaternion in the transform {_shown(numbers[3:])}'
        )
    return said


def too_old(child: str, stamp: int, authority: str) -> str:
    """What tf2 says of a transform that is older than all that it keeps."""
    return (
        f"TF_OLD_DATA ignoring data from the past for frame {child} at time {seconds(stamp)} "
        f"according to authority {authority}\n{EXPLAINED}"
    )


def _xyzw(sample: Sample) -> list[float]:
    w, x, y, z = map(float, sample.placement.rotation)
    return [x, y, z, w]


def _shown(numbers: list[float]) -> str:
    return f"({' '.join(f'{number:f}' for number in numbers)})"
