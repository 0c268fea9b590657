"""Rigid transforms, the place of one frame in another: composed, inverted, interpolated.

The arithmetic is pytransform3d's, loaded when it is first used. Its TemporalTransformManager is not: it takes a whole
series at once and cannot be added to, knows times as floats of seconds, which are 0.2 µs apart today, moves a frame
between two moments along a screw where tf2 goes straight, and has neither tf2's errors nor its rules for new parents.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


class RigidTransform(NamedTuple):
    """A frame in another one."""

    translation: Floats  # m, shape (3,)
    rotation: Floats  # unit quaternion w, x, y, z, shape (4,)

    def __matmul__(self, inner: RigidTransform) -> RigidTransform:  # type: ignore[override]
        """Where `inner` is in the outer one, if it is placed in this frame."""
        from pytransform3d.rotations import concatenate_quaternions

        if self is IDENTITY or inner is IDENTITY:  # at the ends of each way: worth not to compute
            return inner if self is IDENTITY else self
        return RigidTransform(self.at(inner.translation), concatenate_quaternions(self.rotation, inner.rotation))

    def inverse(self) -> RigidTransform:
        """Where the other frame is in this one."""
        from pytransform3d.rotations import q_conj

        if self is IDENTITY:
            return self
        back = RigidTransform(np.zeros(3), q_conj(self.rotation))
        return RigidTransform(-back.turned(self.translation), back.rotation)

    def at(self, point: Floats) -> Floats:
        """Where a point of this frame is in the other one, shape (3,)."""
        return self.translation + self.turned(point)

    def turned(self, vector: Floats) -> Floats:
        """A vector of this frame as the other one sees it, shape (3,)."""
        return self.rotation_matrix() @ vector

    def rotation_matrix(self) -> Floats:
        """The axes of this frame as the other one sees them, a column each."""
        from pytransform3d.rotations import matrix_from_quaternion  # 20 times as quick as its q_prod_vector

        return matrix_from_quaternion(self.rotation)

    def towards(self, later: RigidTransform, ratio: float) -> RigidTransform:
        """Between this one (ratio 0) and a later one (1): straight on, and turning the shorter way."""
        from pytransform3d.rotations import quaternion_slerp

        turned = quaternion_slerp(self.rotation, later.rotation, ratio, shortest_path=True)
        return RigidTransform(self.translation + ratio * (later.translation - self.translation), turned)


IDENTITY = RigidTransform(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
