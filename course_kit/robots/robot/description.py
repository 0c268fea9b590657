"""The robot as URDF, which /robot_description tells. No ROS."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

from course_kit.robots.robot import shape

LEFT, RIGHT = "wheel_left_joint", "wheel_right_joint"


def urdf(prefix: str = "") -> str:
    """The robot's links and joints with simple shapes; each link's name begins with `prefix`."""
    body = shape.HEIGHT - shape.BASE_HEIGHT
    wheel_mass = shape.WHEEL_MASS
    about = wheel_mass * shape.WHEEL_RADIUS**2 / 2  # kg m², about its axle; about the others half of it
    heavy = _inertial(wheel_mass, (0, 0, 0), (about / 2, about, about / 2))
    wheel = _cylinder(shape.WHEEL_RADIUS, shape.WHEEL_WIDTH, (0, 0, 0), (pi / 2, 0, 0))
    mass = shape.MASS - 2 * wheel_mass
    side = shape.WHEEL_SEPARATION / 2
    parts = [
        _link(
            f"{prefix}base_link",
            _cylinder(shape.RADIUS, body, (0, 0, body / 2)) + _inertial(mass, shape.CENTRE, shape.INERTIA),
        ),
        _link(f"{prefix}base_footprint"),
        _link(f"{prefix}base_scan"),
        _link(f"{prefix}imu_link"),
    ]
    for name, y in ((LEFT, side), (RIGHT, -side)):
        link = prefix + name.replace("_joint", "_link")
        parts += [
            _link(link, wheel + heavy),
            _joint(name, "continuous", f"{prefix}base_link", link, (0, y, shape.WHEEL_HEIGHT), '<axis xyz="0 1 0"/>'),
        ]
    for name, link, place in (
        ("base_footprint_joint", "base_footprint", (0.0, 0.0, -shape.BASE_HEIGHT)),
        ("scan_joint", "base_scan", shape.LASER),
        ("imu_joint", "imu_link", shape.IMU),
    ):
        parts.append(_joint(name, "fixed", f"{prefix}base_link", prefix + link, place))
    return "\n".join(['<?xml version="1.0"?>', '<robot name="course_robot">', *parts, "</robot>", ""])


def _link(name: str, inside: str = "") -> str:
    return f'  <link name="{name}">{inside}</link>' if inside else f'  <link name="{name}"/>'


def _joint(name: str, kind: str, parent: str, child: str, place: Sequence[float], axis: str = "") -> str:
    links = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'  <joint name="{name}" type="{kind}">{links}<origin xyz="{_numbers(place)}" rpy="0 0 0"/>{axis}</joint>'


def _cylinder(radius: float, length: float, place: Sequence[float], turn: Sequence[float] = (0, 0, 0)) -> str:
    shape_text = f'<origin xyz="{_numbers(place)}" rpy="{_numbers(turn)}"/>'
    shape_text += f'<geometry><cylinder radius="{radius:g}" length="{length:g}"/></geometry>'
    return f"<visual>{shape_text}</visual><collision>{shape_text}</collision>"


def _inertial(mass: float, place: Sequence[float], inertia: Sequence[float]) -> str:
    values = zip(("ixx", "iyy", "izz"), inertia, strict=True)
    moments = " ".join(f'{name}="{value:g}"' for name, value in values)
    return (
        f'<inertial><origin xyz="{_numbers(place)}" rpy="0 0 0"/><mass value="{mass:g}"/>'
        f'<inertia {moments} ixy="0" ixz="0" iyz="0"/></inertial>'
    )


def _numbers(values: Sequence[float]) -> str:
    return " ".join(f"{value:g}" for value in values)
