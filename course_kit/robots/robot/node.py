"""The node robot: a robot with physics on the topics of a TurtleBot."""

from __future__ import annotations

import math
import time
from contextlib import ExitStack
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Twist, TwistStamped
from PIL import Image
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock as ClockMessage
from std_msgs.msg import String

from course_kit.robots.robot import picture, settings, sharing
from course_kit.robots.robot.description import urdf
from course_kit.robots.robot.sensors import QOS, Sensors
from course_kit.robots.robot.shape import SCAN_PERIOD
from course_kit.robots.robot.simulation import TICK
from course_kit.robots.robot.transforms import Transforms
from course_kit.robots.robot.world import Place, World

TICKS_A_SAMPLE = 5  # 20 Hz of simulated time, as turtlebot3_node reads its board
TICKS_A_SCAN = round(SCAN_PERIOD / TICK)
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
BREAK = 1.0  # s of real time between two lines of a kind in the log
# s of real time between two messages on /clock: each wakes all nodes with simulated time, a fast world's dearest work.
CLOCK_BREAK = 0.0045


class Robot(Node):
    """A robot in a simulated world, for any executor; takes the keyword arguments of rclpy's Node, too.

    Robots of one process with the same world and seed drive in the same simulation.
    """

    def __init__(
        self,
        *,
        world: str | World = "rooms",
        seed: int | None = None,
        start: Place | None = None,
        factor: float | None = None,
        **options: Any,
    ) -> None:
        """`start`: x, y in m, heading in rad; `factor`: simulated seconds a second, 0 for as fast as it goes.

        Without a factor it is 1, or that of the robots that are there. Parameters of the same names win. TypeError or
        ValueError for what cannot be.
        """
        settings.check(world, seed, start, factor)
        self._is_ready = self._is_destroyed = False
        self._leave = ExitStack()
        super().__init__("robot", **options)
        chosen = settings.declare(self, world, seed, start, factor)
        self.world = chosen.world
        self.simulation, self.vehicle = sharing.join(
            self.context,
            chosen.world,
            chosen.factor,
            self._on_tick,
            chosen.start,
            chosen.timeout,
            chosen.patience,
        )
        self._leave.callback(sharing.leave, self.simulation, self.vehicle)
        self._sensors = Sensors(self, chosen.prefix, chosen.noise, (chosen.world.seed or 0, self.vehicle.number))
        self._transforms = Transforms(self, chosen.prefix, self._stamp())
        if chosen.patience:
            self._transforms.hear_corrections(self, self._on_correction)
        self._clock_publisher: Publisher | None = None
        self._bumper = self.create_publisher(String, "bumper", LATCHED)
        self.create_publisher(String, "robot_description", LATCHED).publish(String(data=urdf(chosen.prefix)))
        if chosen.stamped:
            self.create_subscription(TwistStamped, "cmd_vel", self._on_stamped, QOS)
        else:
            self.create_subscription(Twist, "cmd_vel", self._on_command, QOS)
        self._bumps = self._stops = 0  # that were logged
        self._touching: str | None = None  # as was told
        self._said: dict[str, float] = {}  # when a line of a kind was logged last, or the time told: s of real time
        self._is_ready = True
        # Steady, so that neither a changed system time nor use_sim_time stops the world.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(self.simulation.period, self.simulation.advance, clock=steady)
        x, y, heading = self.simulation.true_place(self.vehicle.number)
        self.get_logger().info(f"In the world {self.world.name} at x={x:.2f} m, y={y:.2f} m, heading {heading:.2f} rad")

    def picture(self) -> Image.Image:
        """The world from above with all robots in it, as it is now: RGB, 500 pixels on its longer side."""
        simulation = self.simulation
        with simulation.still:
            seen = [
                picture.Seen(place, simulation.hits(number), simulation.trail(number), name=f"robot {number}")
                for number, place in simulation.true_places().items()
            ]
        return picture.draw(self.world, seen)

    def destroy_node(self) -> None:
        """Take the robot out of its world and the node out of the graph."""
        if not self._is_destroyed:
            self._is_destroyed = True
            self._leave.close()
            super().destroy_node()

    def _on_stamped(self, command: TwistStamped) -> None:
        self._on_command(command.twist)

    def _on_command(self, twist: Twist) -> None:
        linear, angular = twist.linear.x, twist.angular.z
        if math.isfinite(linear) and math.isfinite(angular):
            self.vehicle.command(linear, angular, self.simulation.time)
        else:
            self._warn("command", f"Ignored a command on cmd_vel: its numbers must be finite, not {linear}, {angular}")

    def _on_correction(self, stamp: Time) -> None:
        self.vehicle.correct(stamp.sec + stamp.nanosec * 1e-9, self.simulation.time)

    def _on_tick(self) -> None:
        """Tell what is due: called after each tick, in the thread of whichever robot has moved the world."""
        if not self._is_ready or not self.context.ok():
            return
        simulation, number, ticks = self.simulation, self.vehicle.number, self.simulation.ticks
        stamp = self._stamp()
        if number == simulation.first:
            self._tell_time(stamp)
        if ticks % TICKS_A_SAMPLE == 0:
            wheels = simulation.wheels(number)
            self._sensors.publish_wheels(stamp, self.vehicle, wheels)
            self._transforms.publish(stamp, self.vehicle.odometry.place, wheels[0].tolist())
            self._sensors.publish_imu(stamp, simulation.imu(number))
        if ticks % TICKS_A_SCAN == 0:
            self._sensors.publish_scan(stamp, simulation.scan(number))
        self._tell_bumps()

    def _tell_time(self, stamp: Time) -> None:
        if self._clock_publisher is None:
            self._clock_publisher = self.create_publisher(ClockMessage, "/clock", QOS)
        if self._is_due("clock", CLOCK_BREAK):
            self._clock_publisher.publish(ClockMessage(clock=stamp))

    def _tell_bumps(self) -> None:
        vehicle = self.vehicle
        if vehicle.touching != self._touching:
            self._touching = vehicle.touching
            self._bumper.publish(String(data=vehicle.touching))
        if vehicle.bumps != self._bumps:
            self._bumps = vehicle.bumps
            self._warn("bump", f"Bumped into a {vehicle.last_bumps[-1].what}: bump {vehicle.bumps}")
        if vehicle.watchdog_stops != self._stops:
            self._stops = vehicle.watchdog_stops
            text = f"No command on cmd_vel for {vehicle.timeout:g} s, so it stops: send commands steadily, 10 a second"
            self._warn("watchdog", text)

    def _stamp(self) -> Time:
        seconds, nanoseconds = divmod(self.simulation.nanoseconds, 1_000_000_000)
        return Time(sec=seconds, nanosec=nanoseconds)

    def _warn(self, kind: str, text: str) -> None:
        if self._is_due(kind, BREAK):
            self.get_logger().warning(text)

    def _is_due(self, kind: str, apart: float) -> bool:
        """True where the last of a kind is `apart` s of real time ago or more; this one counts as the last then."""
        now = time.monotonic()
        if now - self._said.get(kind, -math.inf) < apart:
            return False
        self._said[kind] = now
        return True
