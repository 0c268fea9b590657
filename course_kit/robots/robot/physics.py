"""Robots in a world, moved by MuJoCo: wheels that grip and slip, mass, motors, walls; what their sensors would see.

No ROS, and no clock of its own: it stands still between two calls of step(). The same world, seed, starts and calls
give the same run, bit for bit.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass, field

import mujoco
import numpy as np

from course_kit.robots.robot import shape
from course_kit.robots.robot.model import SEEN, Tyres, mjcf
from course_kit.robots.robot.world import Floats, Place, World

WORN = (
    0.0005,
    0.0015,
)  # one tyre of a robot is larger and the other smaller than WHEEL_RADIUS, by a part between these
SETTLING = 200  # steps until a robot that is put on the floor has sunk into its tyres
RAMP = shape.MAX_ACCELERATION / shape.WHEEL_RADIUS * shape.STEP  # rad/s: how far a motor's rate is led in a step
GROUPS = (np.arange(6) == SEEN).astype(np.uint8)  # what rays meet
ANGLES = np.arange(shape.RAYS) * (math.tau / shape.RAYS)
RAYS = np.column_stack([np.cos(ANGLES), np.sin(ANGLES), np.zeros(shape.RAYS)])
NOTHING = World("nothing", (), (), (0.0, 0.0, 0.0), ())


@dataclass
class _Robot:
    """What belongs to one robot, and where in MuJoCo's arrays its part is."""

    tyres: Tyres
    stands: tuple[float, Floats]  # its height and quaternion on the floor, looking along x
    wanted: tuple[float, float] = (0.0, 0.0)  # rad/s, left and right
    touched: str = ""
    positions: slice = field(init=False)
    velocities: slice = field(init=False)
    motors: slice = field(init=False)
    acceleration: slice = field(init=False)
    body: int = field(init=False)
    laser: int = field(init=False)
    state: dict[str, Floats] = field(default_factory=dict)  # while the model is made anew


class Physics:
    """Robots 0, 1, … in a world, each at its start; `seed` draws how worn their tyres are.

    `model` and `data` are MuJoCo's own, to look at; both are new after add() and remove(). Not for two threads at once.
    """

    model: mujoco.MjModel
    data: mujoco.MjData

    def __init__(self, world: World, starts: Sequence[Place], seed: int = 0) -> None:
        self.world = world
        self._seed = seed
        self._steps = self._made = 0
        self._robots: dict[int, _Robot] = {}
        for place in starts:
            self.add(place)

    @property
    def time(self) -> float:
        """Simulated seconds."""
        return self._steps * shape.STEP

    # Robots come and go.

    def add(self, place: Place) -> int:
        """Put one more robot into the world, at rest; return its number. The others go on as they were."""
        self._check(place)
        number, self._made = self._made, self._made + 1
        tyres = _tyres(self._seed, number)
        self._make({**self._robots, number: _Robot(tyres, _standing(tyres))})
        self.place(number, place)
        return number

    def remove(self, robot: int) -> None:
        """Take a robot out of the world; the others keep their numbers."""
        self._make({number: one for number, one in self._robots.items() if number != robot})

    def place(self, robot: int, place: Place) -> None:
        """Put a robot there, at rest; its wheels stay turned as they are."""
        self._check(place, robot)
        one = self._robots[robot]
        x, y, heading = place
        height, tilt = one.stands
        quaternion = np.empty(4)
        mujoco.mju_mulQuat(quaternion, np.array([math.cos(heading / 2), 0.0, 0.0, math.sin(heading / 2)]), tilt)
        self.data.qpos[one.positions][:7] = x, y, height, *quaternion
        self.data.qvel[one.velocities] = 0.0
        self.data.qacc_warmstart[one.velocities] = 0.0
        self.data.ctrl[one.motors] = one.wanted = (0.0, 0.0)
        self.data.act[one.motors] = self.data.qpos[one.positions][7:]
        mujoco.mj_forward(self.model, self.data)

    def _check(self, place: Place, robot: int | None = None) -> None:
        """ValueError where a robot cannot stand."""
        if not all(map(math.isfinite, place)):
            raise ValueError(f"A robot's place is x and y in m and its heading in rad, not {place}.")
        x, y, _ = place
        if self.world.walls and not self._is_inside(x, y):
            raise ValueError(f"({x:g}, {y:g}) is outside the world {self.world.name!r}.")
        if self.world.clearance(x, y) < shape.RADIUS:
            raise ValueError(
                f"A robot has no room at ({x:g}, {y:g}) of the world {self.world.name!r}: a wall is there."
            )
        for number in self._robots.keys() - {robot}:
            if math.dist((x, y), self.pose(number)[:2]) < 2 * shape.RADIUS:
                raise ValueError(f"A robot has no room at ({x:g}, {y:g}): robot {number} is there.")

    def _is_inside(self, x: float, y: float) -> bool:
        x0, y0, x1, y1 = self.world.bounds()
        return x0 < x < x1 and y0 < y < y1

    def _make(self, robots: dict[int, _Robot]) -> None:
        """Make the model of these robots; those that were there before keep their state."""
        for one in self._robots.values():
            one.state = {
                "qpos": self.data.qpos[one.positions].copy(),
                "qvel": self.data.qvel[one.velocities].copy(),
                "qacc_warmstart": self.data.qacc_warmstart[one.velocities].copy(),
                "ctrl": self.data.ctrl[one.motors].copy(),
                "act": self.data.act[one.motors].copy(),
            }
        self._robots = robots
        self.model = mujoco.MjModel.from_xml_string(mjcf(self.world, {n: one.tyres for n, one in robots.items()}))
        self.data = mujoco.MjData(self.model)
        for number, one in robots.items():
            self._find(number, one)
            parts = {"qpos": one.positions, "ctrl": one.motors, "act": one.motors}
            for name, values in one.state.items():
                getattr(self.data, name)[parts.get(name, one.velocities)] = values
            one.state = {}
        names = [self.model.geom(number).name for number in range(self.model.ngeom)]
        self._kinds = [_kind(name) for name in names]
        self._bumpers = {self.model.geom(f"bumper{number}").id: one for number, one in robots.items()}

    def _find(self, number: int, one: _Robot) -> None:
        joint, motor = self.model.joint(f"robot{number}"), self.model.actuator(f"left{number}").id
        position, velocity = int(joint.qposadr[0]), int(joint.dofadr[0])
        one.positions = slice(position, position + 9)  # x, y, z, quaternion wxyz, left, right
        one.velocities = slice(velocity, velocity + 8)  # linear in the world, angular in the body, left, right
        one.motors = slice(motor, motor + 2)
        sensor = int(self.model.sensor(f"acceleration{number}").adr[0])
        one.acceleration = slice(sensor, sensor + 3)
        one.body = self.model.body(f"robot{number}").id
        one.laser = self.model.site(f"laser{number}").id

    # What happens.

    def drive(self, robot: int, left: float, right: float) -> None:
        """Have the motors turn the wheels at these rates, rad/s, from now on: as fast as they can get there."""
        if not (math.isfinite(left) and math.isfinite(right)):
            raise ValueError(f"Wheels turn at finite rates in rad/s, not at {left} and {right}.")
        most = shape.MAX_WHEEL_RATE
        self._robots[robot].wanted = (max(-most, min(most, left)), max(-most, min(most, right)))

    def step(self, count: int = 1) -> None:
        """Let `count` times STEP pass."""
        for one in self._robots.values():
            one.touched = ""
        for _ in range(count):
            self._lead()
            mujoco.mj_step(self.model, self.data)
            self._steps += 1
            self._feel()

    def _lead(self) -> None:
        """Lead the motors towards the wanted rates, no faster than their controller does."""
        for one in self._robots.values():
            left, right = self.data.ctrl[one.motors]
            if (left, right) != one.wanted:
                new = (
                    rate + max(-RAMP, min(RAMP, aim - rate))
                    for rate, aim in zip((left, right), one.wanted, strict=True)
                )
                self.data.ctrl[one.motors] = tuple(new)

    def _feel(self) -> None:
        """Note what bumpers have met."""
        for first, second in self.data.contact.geom.tolist():
            for this, other in ((first, second), (second, first)):
                if this in self._bumpers:
                    self._bumpers[this].touched = self._kinds[other]

    # What there is to know.

    def pose(self, robot: int) -> Place:
        """Where a robot truly is: x, y in m, heading in rad (-π to π)."""
        x, y, _, w, i, j, k = self.data.qpos[self._robots[robot].positions][:7].tolist()
        return x, y, math.atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k))

    def twist(self, robot: int) -> tuple[float, float]:
        """How a robot truly moves: forward in m/s, turning in rad/s."""
        east, north, _, _, _, turning = self.data.qvel[self._robots[robot].velocities][:6].tolist()
        heading = self.pose(robot)[2]
        return east * math.cos(heading) + north * math.sin(heading), turning

    def wheels(self, robot: int) -> tuple[Floats, Floats]:
        """How far the wheels (left, right) have turned in all, rad, and their rates, rad/s."""
        one = self._robots[robot]
        return self.data.qpos[one.positions][7:].copy(), self.data.qvel[one.velocities][6:].copy()

    def imu(self, robot: int) -> tuple[Floats, Floats, Floats]:
        """What imu_link feels: orientation (quaternion xyzw), turning (rad/s), acceleration with gravity (m/s²)."""
        one = self._robots[robot]
        w, i, j, k = self.data.qpos[one.positions][3:7]
        turning = self.data.qvel[one.velocities][3:6].copy()
        return np.array([i, j, k, w]), turning, self.data.sensordata[one.acceleration].copy()

    def scan(self, robot: int) -> Floats:
        """How far the laser sees, m: RAYS values, the first ahead, then counter-clockwise; inf: nothing within LONGEST.

        True values: without noise, and also below SHORTEST.
        """
        one = self._robots[robot]
        mujoco.mj_kinematics(self.model, self.data)  # mj_step leaves places as they were before it
        rays = (RAYS @ self.data.xmat[one.body].reshape(3, 3).T).ravel()
        ranges, geoms = np.empty(shape.RAYS), np.empty(shape.RAYS, np.int32)
        place = self.data.site_xpos[one.laser]
        mujoco.mj_multiRay(
            self.model, self.data, place, rays, GROUPS, 1, one.body, geoms, ranges, None, shape.RAYS, shape.LONGEST
        )
        ranges[(geoms < 0) | (ranges > shape.LONGEST)] = np.inf
        return ranges

    def touches(self, robot: int) -> str:
        """What a robot has bumped into during the last step(): "wall", "pillar", "robot", or "" for nothing."""
        return self._robots[robot].touched

    def energy(self) -> float:
        """The energy of all robots, of place and of motion, J."""
        return float(self.data.energy.sum())


def _kind(geom: str) -> str:
    """What a geom is for whoever bumps into it."""
    name = geom.rstrip("0123456789")
    return "robot" if name == "bumper" else name


def _tyres(seed: int, number: int) -> Tyres:
    draw = random.Random(f"{seed} {number}")
    worn = draw.uniform(*WORN) * draw.choice((-1, 1))
    return Tyres(shape.WHEEL_RADIUS * (1 + worn), shape.WHEEL_RADIUS * (1 - worn))


def _standing(tyres: Tyres) -> tuple[float, Floats]:
    """The height and the quaternion of a robot that stands alone on the floor, looking along x."""
    model = mujoco.MjModel.from_xml_string(mjcf(NOTHING, {0: tyres}))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, SETTLING)
    return float(data.qpos[2]), data.qpos[3:7].copy()
