"""The node turtlesim: the turtles' world on ROS, with the names, types and numbers of the original."""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable
from typing import Any

from PIL import Image
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from std_srvs.srv import Empty
from turtlesim.srv import Kill, Spawn

from course_kit.robots.turtlesim import picture
from course_kit.robots.turtlesim.drawing_report import DrawingReport
from course_kit.robots.turtlesim.turtle import TICK
from course_kit.robots.turtlesim.turtle_interface import TurtleInterface
from course_kit.robots.turtlesim.world import World

BACKGROUND = {"background_r": 69, "background_g": 86, "background_b": 255}
# A turtle's name begins the names of its topics, so it follows ROS's rules for them.
MAKES_UP = 2_000_000_000  # nanoseconds
_VALID_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*")


class TurtleSim(Node):
    """A turtlesim without a window, for any executor; takes the keyword arguments of rclpy's Node."""

    def __init__(self, *, period: float = TICK, keeps_up: bool = False, **options: Any) -> None:
        """`period`: seconds from tick to tick; a longer one slows the simulator down.

        As the original's, its time stands still while the machine is too busy for a tick; if it `keeps_up`, it makes
        up for those that it missed, those of MAKES_UP seconds at most.
        """
        super().__init__("turtlesim", **options)
        self._declare()
        self.get_logger().info(f"Starting turtlesim with node name {self.get_fully_qualified_name()}")
        self.world = World(time.monotonic_ns())
        self._interfaces: dict[str, TurtleInterface] = {}
        self._retired: dict[str, TurtleInterface] = {}
        self._destroyed = False
        self._tick_lock = threading.RLock()  # destroy_node() may be called while another thread ticks
        self.create_service(Empty, "clear", self.serving(lambda _: self.world.clear()))
        self.create_service(Empty, "reset", self.serving(lambda _: self.world.reset(time.monotonic_ns())))
        self.create_service(Spawn, "spawn", self._on_spawn)
        self.create_service(Kill, "kill", self.serving(lambda request: self.world.kill(request.name)))
        self._report = DrawingReport(self, self.world)
        self._follow_world()
        self.settle()
        self._period, self._keeps_up = round(period * 1e9), keeps_up
        self._due = 0  # when the next tick is, as of time.monotonic_ns(); 0 before the first
        # Steady, so that neither a changed system time nor use_sim_time stops the turtles. rcl's timers do
        # not drift, and after a stall they skip what was missed.
        self.create_timer(period, self._tick_as_due, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def picture(self) -> Image.Image:
        """The field with its trails and turtles as it is now: RGB, 500 x 500 pixels. From any thread."""
        red, green, blue = (self.get_parameter(name).value for name in BACKGROUND)
        return picture.draw(self.world.scene(), (red, green, blue))

    def settle(self) -> None:
        """After anything that happened to the world: log what it said, end the goals that it ended."""
        for level, text in self.world.take_log():
            # One call for each level: rclpy ties a level to the place it is called from.
            if level == "info":
                self.get_logger().info(text)
            elif level == "warn":
                self.get_logger().warning(text)
            else:
                self.get_logger().error(text)
        for interface in (*self._interfaces.values(), *self._retired.values()):
            interface.rotate.settle()
        self._report.settle()

    def serving(self, change: Callable[[Any], object]) -> Callable[[Any, Any], Any]:
        """The callback of a service that changes the world by what is asked and answers nothing."""

        def serve(request: Any, response: Any) -> Any:
            change(request)
            self._follow_world()
            self.settle()
            return response

        return serve

    def destroy_node(self) -> None:
        """Take the node and all its turtles out of the graph; running goals are aborted."""
        with self._tick_lock:
            if self._destroyed:
                return
            self._destroyed = True
            for interface in (*self._interfaces.values(), *self._retired.values()):
                interface.destroy()
            super().destroy_node()

    def _declare(self) -> None:
        for name, value in BACKGROUND.items():
            description = f"Background colour, part {name[-1]}; the picture follows at once"
            limits = [IntegerRange(from_value=0, to_value=255, step=1)]
            descriptor = ParameterDescriptor(description=description, integer_range=limits)
            self.declare_parameter(name, value, descriptor)
        description = "Whether turtles also go sideways, by linear.y of cmd_vel"
        self.declare_parameter("holonomic", False, ParameterDescriptor(description=description))

    def _tick_as_due(self) -> None:
        now = time.monotonic_ns()
        if self._keeps_up:
            self._due = max(self._due or now, now - MAKES_UP)
            while self._due <= now - self._period:
                self._tick(self._due)
                self._due += self._period
            self._due += self._period
        self._tick(now)

    def _tick(self, now: int) -> None:
        with self._tick_lock:
            if self._destroyed:
                return
            for interface in self._interfaces.values():
                interface.rotate.pass_cancels()
            for name, reading in self.world.tick(now).items():
                self._interfaces[name].publish(reading)
            self.settle()
            for name, interface in list(self._retired.items()):
                if not interface.linger():
                    self._retired.pop(name).destroy()

    def _follow_world(self) -> None:
        """Give every turtle of the world an interface, and take those of the others away."""
        for name in self._interfaces.keys() - self.world.turtles.keys():
            interface = self._retired[name] = self._interfaces.pop(name)
            interface.retire()
        for name in self.world.turtles.keys() - self._interfaces.keys():
            back = self._retired.pop(name, None)
            if back is not None:
                back.revive()
            self._interfaces[name] = back or TurtleInterface(self, name)

    def _on_spawn(self, request: Spawn.Request, response: Spawn.Response) -> Spawn.Response:
        if request.name and not _VALID_NAME.fullmatch(request.name):
            self._refuse(request.name, "a ROS name has letters, digits and _, and no digit first")
            return response
        name = self.world.spawn(request.name, request.x, request.y, request.theta, time.monotonic_ns())
        try:
            self._follow_world()
            response.name = name
        except Exception as error:  # ROS has more rules than the pattern, such as a name's length
            self.world.kill(name)
            self.world.take_log()
            self._refuse(name, str(error).splitlines()[0])
        self.settle()
        return response

    def _refuse(self, name: str, why: str) -> None:
        self.get_logger().error(f"Cannot spawn a turtle named [{name}] with a topic {name}/cmd_vel: {why}")
