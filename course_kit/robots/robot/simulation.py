"""One world with its robots and its clock, shared by all who ride along. No ROS.

Time is counted in ticks from 0. What happens in a tick depends on the seed and the commands alone, never on how fast
the ticks follow one another.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager

import numpy as np

from course_kit.robots.robot.physics import Physics
from course_kit.robots.robot.shape import LASER, RADIUS, RAYS, STEP
from course_kit.robots.robot.vehicle import Bump, Vehicle
from course_kit.robots.robot.world import Floats, Place, World

STEPS = 2  # of the physics in a tick
TICK = STEP * STEPS  # s of simulated time
TICK_NS = round(TICK * 1e9)
MAKES_UP = 0.5  # s of real time that are made up for after a stall; what is more is lost
AT_ONCE = 0.002  # s of real time that a call works at most: then whoever shares its thread has a turn
PERIOD = AT_ONCE * 1.25  # s of real time from call to call of whoever hurries: then other threads have a turn
TIMEOUT = 0.5  # s of simulated time without a command, after which a robot stops
ROOM = RADIUS + 0.05  # m around a start that are free
Rider = Callable[[], None]


class Simulation:
    """A world in which robots drive. Places in m and rad in the frame `map`; `number` is that of a robot.

    It moves when somebody calls advance() often enough; of several threads that do, one has the work.
    """

    def __init__(self, world: World, factor: float = 1.0, clock: Callable[[], float] = time.monotonic) -> None:
        """`factor`: simulated seconds a second; 0: as fast as it goes."""
        self.world = world
        self.ticks = 0
        self.go_at(factor)
        self._clock = clock
        self._due: float | None = None  # when the next tick is, by the clock
        self._ticked_at = -math.inf  # when the last tick was, by the clock
        self._lock = threading.RLock()
        self._physics = Physics(world, [], world.seed or 0)
        self._vehicles: dict[int, Vehicle] = {}  # by number
        self._riders: dict[int, Rider] = {}

    @property
    def period(self) -> float:
        """How often advance() is to be called: from call to call, s of real time."""
        return max(self._tick_period, PERIOD)

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return self.ticks * TICK

    @property
    def nanoseconds(self) -> int:
        """Simulated time, ns."""
        return self.ticks * TICK_NS

    @property
    def still(self) -> AbstractContextManager[object]:
        """In a `with` block nothing moves."""
        return self._lock

    # Robots come and go.

    def join(
        self, rider: Rider, start: Place | None = None, timeout: float = TIMEOUT, patience: float = 0.0
    ) -> Vehicle:
        """Put a robot into the world, and call `rider` after each tick, in the thread that advances.

        Without a start it is the world's own, or a free place near it. A command holds for `timeout` s,
        and the second half of that takes `patience` s of real time at least; with patience, time is also no faster than
        real time while the correction of its odometry is late. ValueError for a start that is not free.
        """
        with self._lock:
            place = self._free_start() if start is None else start
            number = self._physics.add(place)
            vehicle = self._vehicles[number] = Vehicle(number, place, timeout, patience)
            self._riders[number] = rider
            return vehicle

    def leave(self, number: int) -> None:
        """Take a robot out of the world; its rider is called no more once this returns."""
        with self._lock:
            if self._riders.pop(number, None) is not None:
                del self._vehicles[number]
                self._physics.remove(number)

    @property
    def is_empty(self) -> bool:
        """True if no robot is left."""
        return not self._vehicles

    @property
    def first(self) -> int:
        """The number of the robot that has been there longest."""
        return next(iter(self._vehicles))

    def _free_start(self) -> Place:
        """The world's start, or a place near it where nobody is."""
        x, y, heading = self.world.start
        others = [self._physics.pose(number) for number in self._vehicles]
        for turn, away in [(0.0, 0.0), *_ring_by_ring()]:
            angle = heading + turn
            place = x + away * math.cos(angle), y + away * math.sin(angle)
            apart = min((math.dist(place, other[:2]) for other in others), default=math.inf)
            # In sight of the start: neither outside nor in another room.
            sight = float(self.world.distances(x, y, angle, math.inf))
            if apart > 2 * ROOM and (not away or (sight > away and self.world.clearance(*place) > ROOM)):
                return *place, heading
        raise ValueError(f"the world {self.world.name!r} has no room for one more robot near its start")

    # Time goes on.

    def go_at(self, factor: float) -> None:
        """Go at so many simulated seconds a second from now on; 0: as fast as it goes."""
        self.factor = factor
        self._tick_period = TICK / factor if factor else 0.0  # s of real time

    def advance(self) -> None:
        """Have happen what is due by now, for AT_ONCE at most. Returns at once if another thread is at it."""
        if not self._lock.acquire(blocking=False):
            return
        try:
            if self.is_empty:
                return
            now = self._clock()
            self._due = max(now if self._due is None else self._due, now - MAKES_UP)
            until = now + AT_ONCE
            while self._due <= now < until and not self._lingers(now):
                self.tick()
                self._ticked_at = now
                self._due += self._tick_period
                now = self._clock()
            if self._lingers(now):
                self._due = max(self._due, now)
        finally:
            self._lock.release()

    def _lingers(self, now: float) -> bool:
        """Return True if time is slow for a robot whose next command, or the correction of whose odometry, is late.

        It does not stand still: a node's timer may have missed the last /clock, and then needs another one.
        """
        slowed = max(one.slows(self.time) for one in self._vehicles.values())
        return now - self._ticked_at < TICK * slowed

    def tick(self) -> None:
        """Let TICK of simulated time go by, whatever the clock says."""
        with self._lock:
            physics, before = self._physics, self.time
            for number, vehicle in self._vehicles.items():
                physics.drive(number, *vehicle.rates(before))
            physics.step(STEPS)
            self.ticks += 1
            for number, vehicle in self._vehicles.items():
                vehicle.odometry.update(physics.wheels(number)[0].tolist(), TICK)
                vehicle.note(self.time, physics.pose(number), physics.touches(number))
            for rider in list(self._riders.values()):
                rider()

    # What is true, and what sensors without noise say.

    def true_place(self, number: int = 0) -> Place:
        """Where a robot really is."""
        with self._lock:
            return self._physics.pose(number)

    def true_places(self) -> dict[int, Place]:
        """Where all robots really are, by number."""
        with self._lock:
            return {number: self._physics.pose(number) for number in self._vehicles}

    def true_twist(self, number: int = 0) -> tuple[float, float]:
        """How fast it really is: forward in m/s, turning in rad/s."""
        with self._lock:
            return self._physics.twist(number)

    def collisions(self, number: int = 0) -> list[Bump]:
        """What a robot has bumped into and when, the last 1000 times; a vehicle's `bumps` counts them all."""
        with self._lock:
            return list(self._vehicles[number].last_bumps)

    def wheels(self, number: int = 0) -> tuple[Floats, Floats]:
        """Angles (rad) and rates (rad/s) of its wheels, left and right."""
        with self._lock:
            return self._physics.wheels(number)

    def imu(self, number: int = 0) -> tuple[Floats, Floats, Floats]:
        """Orientation (x, y, z, w), angular velocity (rad/s) and acceleration with gravity (m/s²)."""
        with self._lock:
            return self._physics.imu(number)

    def scan(self, number: int = 0) -> Floats:
        """What its laser measures, m, counter-clockwise from ahead; inf where nothing is in reach."""
        with self._lock:
            return self._physics.scan(number)

    def hits(self, number: int = 0) -> Floats:
        """Where the beams of its laser end, shape (n, 2)."""
        with self._lock:
            x, y, heading = self.true_place(number)
            ranges = self.scan(number)
        angles = heading + np.arange(RAYS) * (math.tau / RAYS)
        across = x + LASER[0] * math.cos(heading) - LASER[1] * math.sin(heading)
        up = y + LASER[0] * math.sin(heading) + LASER[1] * math.cos(heading)
        ends = np.column_stack([across + ranges * np.cos(angles), up + ranges * np.sin(angles)])
        return ends[np.isfinite(ranges)]

    def trail(self, number: int = 0) -> list[tuple[float, float]]:
        """Where a robot has been, m: a point every 5 cm of its last 200 m."""
        with self._lock:
            return list(self._vehicles[number].trail)

    def place(self, place: Place, number: int = 0) -> None:
        """Put a robot somewhere, at rest; its odometry does not see that. ValueError if it is not free there."""
        with self._lock:
            self._physics.place(number, place)
            trail = self._vehicles[number].trail
            trail.clear()
            trail.append(place[:2])

    def vehicles(self) -> list[Vehicle]:
        """The robots that are in the world."""
        with self._lock:
            return list(self._vehicles.values())


def _ring_by_ring() -> Iterator[tuple[float, float]]:
    """Angles and distances (m) of places around a robot, the nearest first, and from its left to before it."""
    for ring in range(1, 13):
        for part in range(4 * ring):
            yield math.pi / 2 * (1 + part / ring), 2.2 * ROOM * ring
