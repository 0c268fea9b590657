"""A world and its robots as MJCF, MuJoCo's own language. What may touch what, and what a laser sees, is said here."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from course_kit.robots.robot import shape
from course_kit.robots.robot.world import Pillar, Wall, World

WALL_HEIGHT = 0.5  # m
SEEN = 1  # the group of what a laser sees: walls, pillars, bodies; floor, wheels and bumpers have others
SCRUB = 0.008  # m: times GRIP and load it is the torque that a tyre needs to turn on the spot
GRIP = 0.7  # coefficient of friction, tyre on floor
GEARS = 0.001  # kg m², of a motor and its gears, as the wheel feels it
STIFFNESS, DAMPING = 2.0, 0.1  # N m/rad, N m s/rad: of a motor's controller
HEAD = f"""
<mujoco>
  <option timestep="{shape.STEP}" integrator="implicitfast" cone="elliptic"><flag energy="enable"/></option>
  <compiler angle="radian" autolimits="true"/>
  <default>
    <default class="floor"><geom group="0" contype="0" conaffinity="1" friction="0.05 0.005 0.0001"/></default>
    <default class="wheel">
      <geom group="2" contype="1" conaffinity="0" friction="{GRIP} {SCRUB} 0.0001" priority="1" condim="4"/>
    </default>
    <default class="caster"><geom group="2" contype="1" conaffinity="0" priority="1" condim="1"/></default>
    <default class="wall"><geom group="{SEEN}" contype="0" conaffinity="2" friction="0.3 0.005 0.0001"/></default>
    <default class="body"><geom group="{SEEN}" contype="0" conaffinity="0" mass="0"/></default>
    <default class="bumper"><geom group="2" contype="2" conaffinity="2" friction="0.3 0.005 0.0001" mass="0"/></default>
    <default class="wheel_joint"><joint armature="{GEARS}" damping="0.001"/></default>
  </default>
"""


class Tyres(NamedTuple):
    """What a robot's tyres measure, m; its odometry takes them for WHEEL_RADIUS."""

    left: float
    right: float


def mjcf(world: World, tyres: Mapping[int, Tyres]) -> str:
    """The model, robots by their numbers: geoms wall0 …, pillar0 …; robot7 its joint and body, left7 and right7 …"""
    things = [_wall(number, one) for number, one in enumerate(world.walls)]
    things += [_pillar(number, one) for number, one in enumerate(world.pillars)]
    robots = [_robot(number, one) for number, one in tyres.items()]
    motors = [_motor(number, side) for number in tyres for side in ("left", "right")]
    sensors = [f'<accelerometer name="acceleration{number}" site="imu{number}"/>' for number in tyres]
    return "\n".join(
        [
            HEAD,
            '<worldbody><geom name="floor" class="floor" type="plane" size="0 0 1"/>',
            *things,
            *robots,
            "</worldbody><actuator>",
            *motors,
            "</actuator><sensor>",
            *sensors,
            "</sensor></mujoco>",
        ]
    )


def _wall(number: int, wall: Wall) -> str:
    return (
        f'<geom name="wall{number}" class="wall" type="box" pos="{wall.x} {wall.y} {WALL_HEIGHT / 2}" '
        f'size="{wall.length / 2} {wall.thickness / 2} {WALL_HEIGHT / 2}" euler="0 0 {wall.heading}"/>'
    )


def _pillar(number: int, pillar: Pillar) -> str:
    return (
        f'<geom name="pillar{number}" class="wall" type="cylinder" pos="{pillar.x} {pillar.y} {WALL_HEIGHT / 2}" '
        f'size="{pillar.radius} {WALL_HEIGHT / 2}"/>'
    )


def _robot(number: int, tyres: Tyres) -> str:
    bottom, top = 0.005, shape.HEIGHT - shape.BASE_HEIGHT
    half = (top - bottom) / 2
    # The bumper is a ball whose widest circle is the body's edge: against upright walls the same, and cheap.
    return f"""
<body name="robot{number}" pos="0 0 {shape.BASE_HEIGHT}">
  <freejoint name="robot{number}"/>
  <inertial pos="{_numbers(shape.CENTRE)}" mass="{shape.MASS - 2 * shape.WHEEL_MASS}"
            diaginertia="{_numbers(shape.INERTIA)}"/>
  <geom name="body{number}" class="body" type="cylinder" pos="0 0 {bottom + half}" size="{shape.RADIUS} {half}"/>
  <geom name="bumper{number}" class="bumper" type="sphere" pos="0 0 0.04" size="{shape.RADIUS}"/>
  <geom name="caster{number}" class="caster" type="sphere" pos="{shape.CASTER} 0 {0.01 - shape.BASE_HEIGHT}"
        size="0.01" mass="0"/>
  <site name="laser{number}" pos="{_numbers(shape.LASER)}"/>
  <site name="imu{number}" pos="{_numbers(shape.IMU)}"/>
  {_wheel(number, "left", shape.WHEEL_SEPARATION / 2, tyres.left)}
  {_wheel(number, "right", -shape.WHEEL_SEPARATION / 2, tyres.right)}
</body>"""


def _wheel(number: int, side: str, y: float, radius: float) -> str:
    # Turned so that the joint's axis, z of the wheel, points to the left: a positive rate drives forward. A ball stands
    # for the tyre: it touches the floor where the tyre does, and rolls as smoothly, which MuJoCo's cylinders do not.
    return f"""<body name="{side}{number}" pos="0 {y} {shape.WHEEL_HEIGHT}" euler="{-math.pi / 2} 0 0">
    <joint name="{side}{number}" class="wheel_joint" axis="0 0 1"/>
    <geom name="{side}{number}" class="wheel" size="{radius}" mass="{shape.WHEEL_MASS}"/>
  </body>"""


def _motor(number: int, side: str) -> str:
    # A motor is told a rate; its controller integrates it and holds the wheel to that angle, as a PI controller of the
    # rate does. Both gains are small enough for the inertia of a wheel and its gears: steps do not make them ring.
    return (
        f'<general name="{side}{number}" joint="{side}{number}" dyntype="integrator" gainprm="{STIFFNESS}" '
        f'biastype="affine" biasprm="0 {-STIFFNESS} {-DAMPING}" forcerange="{-shape.MAX_TORQUE} {shape.MAX_TORQUE}"/>'
    )


def _numbers(values: Sequence[float]) -> str:
    return " ".join(map(repr, values))
