"""Finds a robot's place on a map that it has: a particle filter.

An example to read. Some hundreds of guesses, the particles, move as odometry says, each a little differently. A scan
weighs them: seen from a good guess its hits lie on walls. Those that weigh little die, those that weigh much are
doubled, and soon they all are where the robot is. No ROS: the node is Localizer.
"""

from __future__ import annotations

import math

import numpy as np

from course_kit.robots.navigation.grid_map import FREE, UNKNOWN, GridMap
from course_kit.robots.navigation.places import Floats, Place, hits, moved

SPREAD = 0.1  # metres by which a hit may lie beside its wall: noise, cells, and the gaps between particles
STRAY_HIT = 0.05  # what a hit far from all walls counts: somebody may walk there
BEAMS = 45  # of a scan that are weighed; neighbours say the same again
SCATTERED = 0.3  # metres, the same while particles are few and far between
# Of what a beam says so much is its own, for neighbours hit the same wall; less, if of the particles fewer than this
# part would survive: the right one may not be the best at once.
SHARED = (0.4, 0.2, 0.1, 0.05, 0.02)
SURVIVORS = 0.1
# Odometry's noise: rad a rad turned, rad a metre driven, m a metre driven, m a rad turned.
TURN_BY_TURN, TURN_BY_WAY, WAY_BY_WAY, WAY_BY_TURN = 0.15, 0.1, 0.1, 0.02
MANY, ENOUGH = 10000, 400  # particles: while it may be anywhere, and once they are together
TOGETHER = 0.4  # metres of standard deviation
# It is lost if of so many scans in a row less than this part of the hits lies within metres of a wall.
MISFITS, POOR, FITTING = 5, 0.7, 0.15


class ParticleFilter:
    """Particles on a map; scatter() or gather() says where they begin."""

    def __init__(self, grid_map: GridMap, seed: int = 0) -> None:
        self.map = grid_map
        self.random = np.random.default_rng(seed)
        self.particles: Floats = np.zeros((0, 3))  # x, y, heading: shape (n, 3)
        self.weights: Floats = np.zeros(0)  # they add up to 1
        self._misfits = 0  # in a row
        self.scatter()

    def scatter(self) -> None:
        """Nothing is known: particles on all free cells, in all directions."""
        free = np.nonzero((self.map.cells != UNKNOWN) & (self.map.cells <= FREE))
        chosen = self.random.integers(len(free[0]), size=MANY)
        xy = self.map.centres(free[0][chosen], free[1][chosen])
        xy += self.random.uniform(-0.5, 0.5, (MANY, 2)) * self.map.resolution
        self._set(np.column_stack([xy, self.random.uniform(-math.pi, math.pi, MANY)]))

    def gather(self, place: Place, metres: float = 0.3, radians: float = 0.3) -> None:
        """It is about there: particles around a place, with these standard deviations."""
        self._set(self.random.normal(place, (metres, metres, radians), (MANY // 4, 3)))

    def _set(self, particles: Floats) -> None:
        self.particles, self.weights = particles, np.full(len(particles), 1 / len(particles))

    def move(self, step: Place) -> None:
        """Move each particle by a step of odometry, seen from itself, with noise of its own."""
        turned, way = abs(step[2]), math.hypot(step[0], step[1])
        by_way = WAY_BY_WAY * way + WAY_BY_TURN * turned
        by_turn = TURN_BY_TURN * turned + TURN_BY_WAY * way
        noisy = self.random.normal(step, (by_way, by_way / 2, by_turn), self.particles.shape)
        x, y, heading = self.particles.T
        self.particles = np.column_stack([
            x + noisy[:, 0] * np.cos(heading) - noisy[:, 1] * np.sin(heading),
            y + noisy[:, 0] * np.sin(heading) + noisy[:, 1] * np.cos(heading),
            np.remainder(heading + noisy[:, 2] + math.pi, math.tau) - math.pi,
        ])  # fmt: skip

    def weigh(self, angles: Floats, ranges: Floats, laser: Place = (0.0, 0.0, 0.0)) -> None:
        """Weigh the particles by a scan, then draw new ones where weights differ much; `laser`: on the robot."""
        seen = moved(hits(angles, ranges), laser)
        seen = seen[:: max(1, len(seen) // BEAMS)]
        x, y, heading = self.particles.T[..., None]
        cosine, sine = np.cos(heading), np.sin(heading)
        points = np.stack([x + cosine * seen[:, 0] - sine * seen[:, 1], y + sine * seen[:, 0] + cosine * seen[:, 1]], 2)
        far = self.map.wall_distances(points.reshape(-1, 2)).reshape(len(self.particles), -1)
        spread = SPREAD if self.is_together else SCATTERED
        likely = np.log(np.exp(-(far**2) / (2 * spread**2)) + STRAY_HIT).sum(axis=1)
        likely[self.map.at(self.particles[:, :2]) == UNKNOWN] -= 10  # the robot is not outside of its map
        for shared in SHARED:
            weights = self.weights * np.exp(shared * (likely - likely.max()))
            weights /= weights.sum()
            if _effective(weights) > SURVIVORS * len(weights):
                break
        self.weights = weights
        if _effective(weights) < len(weights) / 2:
            self._resample()
        self._look_whether_lost(seen)

    def _look_whether_lost(self, seen: Floats) -> None:
        """Begin anew when particles are together, and in the wrong place: what the laser sees does not fit there."""
        fit = (self.map.wall_distances(moved(seen, self.place())) < FITTING).mean() if len(seen) else 1.0
        self._misfits = self._misfits + 1 if self.is_together and fit < POOR else 0
        if self._misfits >= MISFITS:
            self._misfits = 0
            self.scatter()

    @property
    def is_together(self) -> bool:
        """True if the particles agree about where the robot is."""
        return max(self.spread()[:2]) < TOGETHER

    def _resample(self) -> None:
        """Draw particles anew by weight, at equal distances along the sum of the weights: the low-variance way."""
        count = ENOUGH if self.is_together else len(self.particles)
        marks = (np.arange(count) + self.random.uniform()) / count
        self._set(self.particles[np.minimum(np.searchsorted(np.cumsum(self.weights), marks), len(self.weights) - 1)])

    def place(self) -> Place:
        """Where the robot is: the mean of the particles by weight."""
        x, y, heading = self.particles.T
        cosine, sine = self.weights @ np.cos(heading), self.weights @ np.sin(heading)
        return float(self.weights @ x), float(self.weights @ y), math.atan2(sine, cosine)

    def covariance(self) -> Floats:
        """How unsure that is: the covariance of x, y and heading, shape (3, 3)."""
        off = self.particles - np.array(self.place())
        off[:, 2] = np.remainder(off[:, 2] + math.pi, math.tau) - math.pi
        return np.asarray((off * self.weights[:, None]).T @ off)

    def spread(self) -> Floats:
        """The standard deviations of x, y (m) and heading (rad)."""
        return np.asarray(np.sqrt(np.diag(self.covariance())))


def _effective(weights: Floats) -> float:
    """How many particles of equal weight would say as much."""
    return float(1 / (weights**2).sum())
