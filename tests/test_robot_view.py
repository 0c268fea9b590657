"""The robot view in a real kernel: what it sends, what it does when told to, what stays of it."""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.kernel import Kernel, kernel_after
from tests.widget_cell import WIDGET, WidgetCell

SET_UP = """
import math, time
import numpy as np
from geometry_msgs.msg import PoseArray, PoseStamped, TransformStamped, Twist, TwistStamped
from nav_msgs.msg import OccupancyGrid, Path
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from tf2_msgs.msg import TFMessage
from course_kit import run, start, stop
from course_kit import show_robot
from course_kit import Robot

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)

class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.linear = self.angular = 0.0
        self.commands = self.create_publisher(TwistStamped, "/cmd_vel", 10)
        self.create_timer(0.1, self.drive)

    def drive(self):
        command = TwistStamped()
        command.twist.linear.x, command.twist.angular.z = self.linear, self.angular
        self.commands.publish(command)

class Listener(Node):
    def __init__(self):
        super().__init__("listener")
        self.goals = []
        self.create_subscription(PoseStamped, "/goal_pose", self.goals.append, 10)

robot, driver = run(Robot, world="empty", start=(1.0, 2.0, 0.0)), run(Driver)
place = lambda: robot.simulation.true_place(robot.vehicle.number)
"""


@pytest.fixture(scope="module")
def kernel() -> Iterator[Kernel]:
    with kernel_after(SET_UP) as one:
        yield one


class Shown(WidgetCell):
    """show_robot() in a cell, with this test in the browser's place."""

    def __init__(self, kernel: Kernel, arguments: str = "robot") -> None:
        super().__init__(kernel, f"view = show_robot({arguments})\nview")

    def layers(self, name: str) -> list[tuple[dict[str, Any], bytes]]:
        """The layers of a name that were sent so far."""
        found = []
        for content, buffers in self.said("layers"):
            data = iter(buffers)
            for layer in content["layers"]:
                own = next(data) if layer["has_data"] else b""
                found += [(layer, own)] if layer["layer"] == name else []
        return found

    def last(self, name: str) -> tuple[dict[str, Any], bytes]:
        """The newest of them; waits for the first."""
        return self.kernel.until(lambda: self.layers(name))[-1]  # type: ignore[no-any-return]

    def text(self) -> str:
        """What stands below the picture."""
        return str(self.last("text")[0]["text"])


@pytest.fixture
def view(kernel: Kernel) -> Iterator[Shown]:
    one = Shown(kernel)
    yield one
    kernel.run("view.stop(); driver.linear = driver.angular = 0.0")


def numbers(kernel: Kernel, code: str) -> list[float]:
    return [*map(float, kernel.value(f"*{code}").split())]


def test_its_end_leaves_a_picture_and_a_text_without_a_widget(kernel: Kernel) -> None:
    view = Shown(kernel)
    view.last("hits")
    kernel.run("view.stop()")
    kernel.until(lambda: WIDGET not in view.still())
    assert view.still()["text/plain"].startswith("The world empty from above: robot at (1.00, 2.00) m, heading 0.00 ")
    drawn = Image.open(io.BytesIO(base64.b64decode(view.still()["image/png"])))
    assert max(drawn.size) == 500
    assert kernel.value("view, view.is_running") == "<robot, stopped> False"


def test_a_browser_that_asks_gets_all_there_is(kernel: Kernel, view: Shown) -> None:
    view.last("hits")
    before = len(view.layers("ground"))
    view.tell(kind="show")
    kernel.until(lambda: len(view.layers("ground")) > before)
    ground, _ = view.last("ground")
    assert len(ground["walls"]) == 4 and all(len(corners) == 4 for corners in ground["walls"])
    (robot,) = view.last("robots")[0]["robots"]
    assert robot["place"] == pytest.approx([1.0, 2.0, 0.0], abs=0.02) and robot["goal"] is None
    assert robot["estimate"] == pytest.approx(robot["place"], abs=0.02)


def test_the_hits_lie_on_the_walls(kernel: Kernel, view: Shown) -> None:
    kernel.until(lambda: len(view.last("hits")[1]) > 0)
    hits = np.frombuffer(view.last("hits")[1], np.float32).reshape(-1, 2)
    code = f"[robot.world.clearance(x, y) for x, y in {hits.tolist()}]"
    assert np.abs(numbers(kernel, code)).max() < 0.1  # noise of the laser


def test_only_what_changes_is_sent_while_it_drives(kernel: Kernel, view: Shown) -> None:
    view.last("hits")
    grounds = len(view.layers("ground"))
    kernel.run("driver.linear, driver.angular = 0.1, 0.5")
    kernel.until(lambda: len(view.layers("trail")) > 8, 30.0)
    steps = [np.frombuffer(data, np.float32).reshape(-1, 2) for _, data in view.layers("trail")]
    assert [layer["from"] for layer, _ in view.layers("trail")] == [0, *np.cumsum([len(one) for one in steps])[:-1]]
    way = np.vstack(steps)
    assert np.hypot(*np.diff(way, axis=0).T).max() < 0.5
    assert len(view.layers("ground")) == grounds and len(view.layers("map")) == 1
    counts = [content["count"] for content, _ in view.said("layers")]
    assert counts == list(range(counts[0], counts[0] + len(counts)))


def test_nothing_is_sent_of_a_robot_that_rests_but_its_laser_and_the_time(kernel: Kernel, view: Shown) -> None:
    kernel.until(lambda: len(view.layers("text")) > 3)
    before = [len(view.layers(name)) for name in ("ground", "map", "trail", "path", "particles")]
    kernel.until(lambda: len(view.layers("text")) > 8)
    assert [len(view.layers(name)) for name in ("ground", "map", "trail", "path", "particles")] == before


def test_a_click_publishes_a_goal_in_its_frame_at_simulated_time(kernel: Kernel, view: Shown) -> None:
    kernel.until(lambda: "s simulated" in view.text())
    view.tell(kind="goal", x=3.0, y=1.0, heading=0.5)
    kernel.until(lambda: view.said("said"))
    assert view.said("said")[-1][0]["text"].endswith(
        "in frame 'odom' on /goal_pose: no node subscribes to that, so nothing drives there."
    )
    kernel.run("listener = run(Listener)")
    kernel.until(lambda: kernel.value("view._watched[0].topics._goals.get_subscription_count()") == "2")
    view.tell(kind="goal", x=3.0, y=1.0, heading=0.5)
    kernel.until(lambda: kernel.value("len(listener.goals)") == "1")
    kernel.run("goal = listener.goals[0]; position, turn = goal.pose.position, goal.pose.orientation")
    # The frame odom lies where the robot began; since then its wheels have driven it, and a little aside.
    x, y, heading = numbers(kernel, "view._watched[0].topics.robot.named((3.0, 1.0, 0.5))")
    assert numbers(kernel, "(position.x, position.y)") == pytest.approx([x, y], abs=1e-6)
    assert numbers(kernel, "(2 * math.atan2(turn.z, turn.w),)") == pytest.approx([heading], abs=1e-6)
    assert kernel.value("0 <= robot.simulation.time - goal.header.stamp.sec - 1e-9 * goal.header.stamp.nanosec < 60")
    kernel.until(lambda: view.last("robots")[0]["robots"][0]["goal"] == pytest.approx([3.0, 1.0, 0.5], abs=2e-3))
    kernel.run("stop(listener)")


MAPPER = """
class Mapper(Node):
    def __init__(self):
        super().__init__("mapper")
        self.tf = self.create_publisher(TFMessage, "/tf", 100)
        self.create_timer(0.1, self.place)
        cells, (x, y) = robot.world.occupancy()
        grid = OccupancyGrid(data=cells.ravel().tolist())
        grid.header.frame_id = "map"
        grid.info.height, grid.info.width = cells.shape
        grid.info.resolution, grid.info.origin.position.x, grid.info.origin.position.y = 0.05, x, y
        self.maps = self.create_publisher(OccupancyGrid, "/map", LATCHED)
        self.maps.publish(grid)
        self.plans = self.create_publisher(Path, "/plan", 1)
        self.clouds = self.create_publisher(PoseArray, "/particle_cloud", 1)

    def place(self):
        # As if it knew all: from the true place and from the wheels' one.
        x, y, heading = after(place(), inverse(robot.vehicle.odometry.place))
        one = TransformStamped(child_frame_id="odom")
        one.header.frame_id, one.header.stamp = "map", robot._stamp()
        one.transform.translation.x, one.transform.translation.y = x, y
        one.transform.rotation.z, one.transform.rotation.w = math.sin(heading / 2), math.cos(heading / 2)
        self.tf.publish(TFMessage(transforms=[one]))
        path, cloud = Path(), PoseArray()
        path.header.frame_id = cloud.header.frame_id = "map"
        for x in (1.0, 2.0, 3.0):
            pose = PoseStamped()
            pose.pose.position.x = x
            path.poses.append(pose)
            cloud.poses.append(pose.pose)
        self.plans.publish(path)
        self.clouds.publish(cloud)

from course_kit import after, inverse
mapper = run(Mapper)
"""


def test_map_plan_and_particles_are_drawn_where_transforms_have_them(kernel: Kernel, view: Shown) -> None:
    kernel.run(MAPPER)
    kernel.until(lambda: view.last("map")[0]["place"] is not None and view.last("path")[1])
    told, png = view.last("map")
    assert told["place"] == pytest.approx([*numbers(kernel, "robot.world.occupancy()[1]"), 0.0], abs=1e-6)
    assert Image.open(io.BytesIO(png)).size[::-1] == (*map(int, numbers(kernel, "robot.world.occupancy()[0].shape")),)
    kernel.until(lambda: view.last("particles")[1])
    path = np.frombuffer(view.last("path")[1], np.float32).reshape(-1, 2)
    assert path == pytest.approx(np.array([[1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]), abs=1e-3)
    kernel.run("stop(mapper)")


def test_a_robot_in_another_process_is_seen_by_its_topics_and_its_map(kernel: Kernel) -> None:
    kernel.run(
        "other = start('python -m course_kit.robots.robot --ros-args -r __ns:=/robot2 -p world:=empty -p seed:=5')",
    )
    view = Shown(kernel, "'/robot2'")
    kernel.until(lambda: view.last("robots")[0]["robots"], 40.0)
    assert view.last("ground")[0]["walls"] == []
    (robot,) = view.last("robots")[0]["robots"]
    assert robot["name"] == "robot2" and robot["estimate"] is None
    kernel.until(lambda: "robot2  x 0.00 m, y 0.00 m" in view.text())
    kernel.until(lambda: view.last("hits")[1])
    kernel.run("other.stop()")
    kernel.until(lambda: "No robot: no node publishes /robot2/odom." in view.text(), 40.0)
    kernel.run("view.stop()")
    kernel.until(lambda: WIDGET not in view.still())
    assert view.still()["text/plain"] == "What is known of the world from above: no robot."


def test_two_robots_of_one_world_are_both_shown(kernel: Kernel) -> None:
    kernel.run("second = run(Robot, world='empty', start=(3.0, 3.0, 0.0), namespace='/robot2')")
    one = Shown(kernel)
    kernel.until(lambda: len(one.last("robots")[0]["robots"]) == 2)  # the other one too, of which nobody has asked
    assert one.last("robots")[0]["robots"][1]["place"] == pytest.approx([3.0, 3.0, 0.0], abs=0.02)
    kernel.run("view.stop()")
    both = Shown(kernel, "robot, second")
    kernel.until(lambda: "robot2  x 3.00 m" in both.text() and "robot  x " in both.text())
    kernel.until(lambda: {layer["robot"] for layer, data in both.layers("hits") if data} == {0, 1})
    kernel.run("stop(second)")
    kernel.until(lambda: "robot2 was stopped." in both.text())
    kernel.run("view.stop()")


def test_a_bump_is_told(kernel: Kernel, view: Shown) -> None:
    kernel.run("robot.simulation.place((0.3, 2.0, math.pi), robot.vehicle.number); driver.linear = 0.2")
    kernel.until(lambda: "1 bump, the last into a wall" in view.text(), 30.0)
    kernel.run("driver.linear = 0.0; robot.simulation.place((1.0, 2.0, 0.0), robot.vehicle.number)")


def test_nothing_is_sent_while_nobody_looks_and_all_of_it_afterwards(kernel: Kernel) -> None:
    tab = "a browser tab"
    session, channel = kernel.client.session, kernel.client.shell_channel
    view = Shown(kernel)
    view.last("hits")
    content = {"comm_id": tab, "target_name": "course_kit.views", "data": {"looks": False}}
    channel.send(session.msg("comm_open", content))
    kernel.until(
        lambda: kernel.value("__import__('course_kit.views.live.tabs').views.live.tabs.somebody_looks()") == "False"
    )
    kernel.until(lambda: kernel.value("time.monotonic() - view._shown_at > 1.0") == "True")  # so all is sent anew
    before, began_at = len(view.said("layers")), numbers(kernel, "place()")[0]
    kernel.run("driver.linear = 0.1")
    kernel.until(lambda: numbers(kernel, "place()")[0] > began_at + 0.1, 30.0)
    assert len(view.said("layers")) == before
    grounds = len(view.layers("ground"))
    channel.send(session.msg("comm_msg", {"comm_id": tab, "data": {"looks": True}}))
    kernel.until(lambda: len(view.layers("ground")) > grounds)
    trail = np.frombuffer(view.last("trail")[1], np.float32).reshape(-1, 2)
    assert view.layers("trail")[-1][0]["from"] == 0 or len(trail) > 0  # what it has driven meanwhile
    channel.send(session.msg("comm_close", {"comm_id": tab, "data": {}}))
    kernel.run("view.stop(); driver.linear = 0.0; from course_kit.views.live import tabs; tabs._looking.clear()")


def test_the_same_robot_is_shown_once(kernel: Kernel, view: Shown) -> None:
    kernel.run("first = view")
    again = Shown(kernel)
    again.last("hits")
    assert kernel.value("first.is_running, view.is_running") == "False True"


def test_the_end_of_ros_leaves_the_last_picture(kernel: Kernel) -> None:
    view = Shown(kernel)
    view.last("hits")
    kernel.run("import rclpy; rclpy.shutdown()")
    kernel.until(lambda: WIDGET not in view.still())
    assert view.still()["text/plain"].startswith("The world empty from above: robot at (")
    assert math.isfinite(len(view.still()["image/png"]))
