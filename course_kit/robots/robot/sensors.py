"""The robot's sensors as messages: wheels, odometry, IMU, laser. Types, frames and rates of a TurtleBot 3's."""

from __future__ import annotations

import array
import math
from typing import NamedTuple

import numpy as np
from builtin_interfaces.msg import Time
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import Imu, JointState, LaserScan

from course_kit.robots.robot import shape
from course_kit.robots.robot.description import LEFT, RIGHT
from course_kit.robots.robot.transforms import turn
from course_kit.robots.robot.vehicle import Vehicle
from course_kit.robots.robot.world import Floats

QOS = QoSProfile(depth=10)
# Variances as a TurtleBot 4's: x, y, z in m², turns in rad². A TurtleBot 3 says 0, which stands for unknown.
ODOMETRY_VARIANCES = (0.001, 0.001, 0.001, 0.001, 0.001, 0.01)
ORIENTATION_VARIANCE = 1e-6  # rad²: the simulated orientation is the true one


class Noise(NamedTuple):
    """Standard deviations of what is measured; 0 is without noise."""

    scan: float  # m
    gyro: float  # rad/s
    accelerometer: float  # m/s²


class Sensors:
    """The topics odom, joint_states, imu and scan of a robot."""

    def __init__(self, node: Node, prefix: str, noise: Noise, seed: tuple[int, int]) -> None:
        """`seed`: of the world, and the robot's number in it."""
        self._noise = noise
        self._random = np.random.default_rng(seed)
        self._odom = node.create_publisher(Odometry, "odom", QOS)
        self._joints = node.create_publisher(JointState, "joint_states", QOS)
        self._imu = node.create_publisher(Imu, "imu", QOS)
        self._scan = node.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
        self._odometry = Odometry(child_frame_id=f"{prefix}base_link")
        self._odometry.header.frame_id = f"{prefix}odom"
        self._odometry.pose.pose.position.z = shape.BASE_HEIGHT
        for part in (self._odometry.pose, self._odometry.twist):
            part.covariance = np.diag(ODOMETRY_VARIANCES).ravel()
        self._joint_state = JointState(name=[LEFT, RIGHT])
        self._joint_state.header.frame_id = f"{prefix}base_link"
        self._measured = _imu(f"{prefix}imu_link", noise)
        self._ranges = LaserScan(
            angle_max=math.tau * (shape.RAYS - 1) / shape.RAYS,
            angle_increment=math.tau / shape.RAYS,
            scan_time=shape.SCAN_PERIOD,
            range_min=shape.SHORTEST,
            range_max=shape.LONGEST,
        )
        self._ranges.header.frame_id = f"{prefix}base_scan"

    def publish_wheels(self, stamp: Time, vehicle: Vehicle, wheels: tuple[Floats, Floats]) -> None:
        """Tell how the wheels have turned, and where that has taken the robot."""
        odometry, joints = self._odometry, self._joint_state
        odometry.header.stamp = joints.header.stamp = stamp
        pose, twist = odometry.pose.pose, odometry.twist.twist
        pose.position.x, pose.position.y, heading = vehicle.odometry.place
        turn(pose.orientation, heading)
        twist.linear.x, twist.angular.z = vehicle.odometry.twist
        self._odom.publish(odometry)
        joints.position, joints.velocity = (part.tolist() for part in wheels)
        self._joints.publish(joints)

    def publish_imu(self, stamp: Time, measured: tuple[Floats, Floats, Floats]) -> None:
        """Tell orientation, angular velocity and acceleration."""
        message, (orientation, turning, acceleration) = self._measured, measured
        message.header.stamp = stamp
        noise = self._random.standard_normal(6)
        turning = (turning + self._noise.gyro * noise[:3]).tolist()
        acceleration = (acceleration + self._noise.accelerometer * noise[3:]).tolist()
        told = message.orientation, message.angular_velocity, message.linear_acceleration
        told[0].x, told[0].y, told[0].z, told[0].w = orientation.tolist()
        told[1].x, told[1].y, told[1].z = turning
        told[2].x, told[2].y, told[2].z = acceleration
        self._imu.publish(message)

    def publish_scan(self, stamp: Time, ranges: Floats) -> None:
        """Tell what the laser measures; ranges as they are, m, inf where there is nothing in reach."""
        self._ranges.header.stamp = stamp
        noisy = ranges + self._noise.scan * self._random.standard_normal(len(ranges))
        # REP 117: too near is -inf, out of reach is inf.
        noisy = np.where(noisy < shape.SHORTEST, -np.inf, np.where(noisy > shape.LONGEST, np.inf, noisy))
        # An array is taken as it is; of a list each number would be looked at.
        self._ranges.ranges = array.array("f", noisy.astype(np.float32).tobytes())
        self._scan.publish(self._ranges)


def _imu(frame: str, noise: Noise) -> Imu:
    message = Imu()
    message.header.frame_id = frame
    variances = ORIENTATION_VARIANCE, noise.gyro**2, noise.accelerometer**2
    names = "orientation_covariance", "angular_velocity_covariance", "linear_acceleration_covariance"
    for name, variance in zip(names, variances, strict=True):
        setattr(message, name, np.diag([variance] * 3).ravel())
    return message
