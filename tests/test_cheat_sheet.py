"""The cheat sheet: each piece of code in it runs, as it stands there, and it is one page when it is printed.

The terminal's column runs in bash with the course's `ros2`, beside a turtle; the other two in one kernel.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, field
from tempfile import TemporaryFile

import pytest

from course_kit import Workspace
from tests import packages
from tests.cheat_sheet import CHROMIUM, Cell, cells, order_of_looking, pages, pdf
from tests.domains import own_domain
from tests.kernel import Kernel
from tests.waiting import wait_until

pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.timeout(120),
    pytest.mark.by_turns("programs and a workspace"),
]
PATIENCE = 60.0  # seconds for one command, on a busy machine
NOT_RUN = {
    "ros2 run rqt_graph rqt_graph": "it opens a window, and PyPI has no rqt",
    "rosdep install --from-paths src -y --ignore-src": "it installs packages as root, from the network",
}
# These go on until they are interrupted, as soon as they have said what stands below.
GO_ON = re.compile(
    r"ros2 (run (?!tf2_tools)|topic (echo (?!.*--once)|pub (?!.*--once)|hz|bw)|launch (?!.*--show-args)|bag record)|"
    r"\S+ program\.py"
)
SAYS = {
    "ros2 run my_first_pkg talker": "Hello World: 3",
    "ros2 run my_first_pkg talker --ros-args -r __ns": r"\[attic\.talker\]: Hi: 3",
    "ros2 node list": "/turtlesim\n",
    "ros2 node info": "/turtle1/cmd_vel: geometry_msgs/msg/Twist",
    "ros2 topic type": "turtlesim/msg/Pose",
    "ros2 interface show": "float32 theta",
    "ros2 topic echo /turtle1/pose": "theta: ",
    "ros2 topic echo /rosout": "msg: ",
    "ros2 topic pub --rate": "publishing #2: ",
    "ros2 topic hz": r"average rate: \d",
    "ros2 topic bw": "B/s from",
    "ros2 topic info -v": "QoS profile:",
    "ros2 service list": r"/reset \[std_srvs/srv/Empty\]",
    "ros2 service type": "std_srvs/srv/Empty",
    "ros2 service call": r"std_srvs\.srv\.Empty_Response\(\)",
    "ros2 action list": "/turtle1/rotate_absolute",
    "ros2 action send_goal /navigate_to_pose": "Goal finished with status: SUCCEEDED",
    "ros2 action send_goal": "(?s)Feedback:.*Goal finished with status: SUCCEEDED",
    "ros2 param list": "background_r",
    "ros2 param set": "Set parameter successful",
    "ros2 param dump": "ros__parameters:",
    "ros2 pkg executables": "my_first_pkg talker",
    "colcon build": r"Finished <<< my_first_pkg",
    "ros2 launch my_first_pkg talk.launch.py --show-args": "'room':",
    "ros2 launch my_first_pkg talk.launch.py room": r"\[attic\.talker\]: Hello World: 3",
    "ros2 bag record": "(?s)All requested topics are subscribed.*",
    "ros2 bag info": r"Topic: /turtle1/pose .*Count: [1-9]",
    "printenv": r"\d+",
    "ros2 run course_robot robot": "In the world office at",
    "ros2 run tf2_ros tf2_echo": r"Translation: \[",
}
AFTER = {"cancel it, get its result": "send a goal"}  # a row that goes on with what another one has begun
# A row whose commands and code are about what notebook columns have begun, its own or another row's.
BESIDE = {
    "know where frames are: tf": ("run a robot",),
    "have it find its way": ("run a robot", "have it find its way"),
}
IN_A_PROGRAM = {"run a node": "Hello World: 3", "end it": "ended"}  # what they say; in a kernel these would end it all
LAUNCH = """from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument('room', default_value='kitchen'),
        Node(package='my_first_pkg', executable='talker', namespace=LaunchConfiguration('room'), output='screen'),
    ])
"""
IN_A_LAUNCH_FILE = """from launch import LaunchDescription
from launch_ros import actions


def generate_launch_description():
    return {}
"""
IMPORTS = """
import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from nav2_msgs.action import NavigateToPose
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from std_msgs.msg import String
from std_srvs.srv import Empty, Trigger
from tf2_ros import Buffer, TransformListener
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Pose

class Talker(Node):
    def __init__(self, **options):
        super().__init__("talker", **options)
        self.words, self.count = self.declare_parameter("words", "Hello World"), 0
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.1, self.tick)

    def tick(self):
        self.publisher.publish(String(data=f"{self.words.value}: {self.count}"))
        self.get_logger().info(f"{self.words.value}: {self.count}")
        self.count += 1
"""
MAIN = """

def main():
    rclpy.init()
    try:
        rclpy.spin(Talker())
    except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
        pass
"""
NODES = """
from course_kit import *
from course_kit import check_environment
from course_kit.views.live.life import stop_all
from course_kit import Mapper, Navigator, Planner
from course_kit import Robot

class Lamp(Node):
    def __init__(self):
        super().__init__("lamp")
        self.create_service(Trigger, "light", lambda request, response: response)

class Sheet(Node):
    def __init__(self):
        super().__init__("sheet")

    def on_pose(self, pose): pass
    def on_tick(self): pass
    def on_switch(self, request, response): return response
    def on_answer(self, future): pass
    def on_feedback(self, message): pass
"""
RUN = """
stop_all()  # a view of an earlier row draws for as long as the kernel lives
if not any(node.get_name() == "sheet" for node in nodes()):
    self, asker = run(Sheet), run(Node, "asker")
    client, turn = asker.create_client(Empty, "/reset"), ActionClient(asker, RotateAbsolute, "/turtle1/rotate_absolute")
    ws = Workspace("ros2_ws")
    talker = run(Talker)
    assert client.wait_for_service(20.0) and turn.wait_for_server(20.0)
if "sent" in globals():
    wait_for(sent)
if hasattr(self, "ear"):
    wait_for(lambda: self.buffer.can_transform("odom", "base_scan", Time()))
"""


@dataclass
class Bench:
    """A turtle that runs, a built workspace, a kernel."""

    workspace: Workspace
    kernel: Kernel
    begun: set[str] = field(default_factory=set)  # rows whose notebook column has run

    def in_a_terminal(self, command: str, what: str = "") -> None:
        """Run it in bash; interrupt it as soon as it has said what it goes on with."""
        known = max((key for key in SAYS if command.startswith(key)), key=len, default="")
        says = re.compile(what or SAYS.get(known, ""))
        with TemporaryFile("w+") as out:
            process = subprocess.Popen(
                ["bash", "-c", command],
                cwd=self.workspace.folder,
                env={**self.workspace.environment, "PYTHONUNBUFFERED": "1", "COLUMNS": "200"},
                stdout=out,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )

            def said() -> str:
                out.seek(0)
                return out.read()

            goes_on = bool(GO_ON.match(command))
            try:
                wait_until(
                    lambda: process.poll() is not None or (goes_on and says.search(said())),
                    f"the end of `{command}`, or {says.pattern!r}",
                    PATIENCE,
                )
                if "bag record" in command:
                    self.in_a_terminal("ros2 topic echo /turtle1/pose --once")  # so a pose has come since it subscribed
            finally:
                interrupted = process.poll() is None
                if interrupted:
                    os.killpg(process.pid, signal.SIGINT)
                status = process.wait(PATIENCE)
            assert says.search(said()), said()
            assert interrupted or status == 0, said()

    def in_the_kernel(self, code: str) -> None:
        self.kernel.run(RUN, PATIENCE)
        self.kernel.run(code, PATIENCE)

    def begin(self, cell: Cell) -> None:
        """Run the notebook columns of the rows that this one is about, unless they have run."""
        for one in cells():
            if one.column == "notebook" and one.task in BESIDE.get(cell.task, ()) and one != cell:
                if one.task not in self.begun:
                    for code in one.codes:
                        self.in_the_kernel(code)
                self.begun.add(one.task)


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bench]:
    folder = tmp_path_factory.mktemp("notebooks")
    workspace = Workspace(folder / "ros2_ws")
    files = {"talker.py": IMPORTS + MAIN, "__init__.py": ""}
    package = {"setup.py": packages.SETUP_PY, "setup.cfg": packages.SETUP_CFG, "launch/talk.launch.py": LAUNCH}
    package["package.xml"] = packages.package_xml("my_first_pkg", "ament_python", "  <depend>rclpy</depend>")
    package |= {"resource/my_first_pkg": "", **{f"my_first_pkg/{file}": text for file, text in files.items()}}
    named = {file: text.replace("demo_py", "my_first_pkg") for file, text in package.items()}
    packages.write(workspace.src / "my_first_pkg", named)
    with own_domain(), pytest.MonkeyPatch.context() as patch:
        patch.delenv("PYTHONDONTWRITEBYTECODE", raising=False)
        workspace.build()
        command = [sys.executable, "-m", "course_kit.robots.turtlesim"]
        turtle = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            with closing(Kernel(folder)) as kernel:
                kernel.run(IMPORTS + NODES, PATIENCE)
                yield Bench(workspace, kernel)
        finally:
            turtle.send_signal(signal.SIGINT)
            turtle.wait(PATIENCE)


def name(cell: Cell) -> str:
    return f"{cell.column}-{cell.task}"


@pytest.mark.parametrize("cell", cells(), ids=name)
def test_what_the_sheet_says_runs(cell: Cell, bench: Bench) -> None:
    codes = [code for code in cell.codes if code not in NOT_RUN]
    bench.begin(cell)
    if cell.column == "notebook":
        bench.begun.add(cell.task)
    if cell.column == "terminal":
        for code in codes:
            bench.in_a_terminal(code)
    elif cell.column == "rclpy" and cell.task in IN_A_PROGRAM:
        begin = "rclpy.init()\nself = Talker()\n" if cell.task == "end it" else ""
        program = "\n".join([IMPORTS, begin, *codes, "print('ended')"])
        (bench.workspace.folder / "program.py").write_text(program)
        bench.in_a_terminal(f"{sys.executable} program.py", IN_A_PROGRAM[cell.task])
    elif cell.column == "rclpy" and cell.task == "start many":
        (bench.workspace.folder / "many.launch.py").write_text(IN_A_LAUNCH_FILE.format(*codes))
        bench.in_a_terminal("ros2 launch many.launch.py", "Hello World: 3")
    else:
        before = next((c for c in cells() if (c.column, c.task) == (cell.column, AFTER.get(cell.task))), None)
        for code in (before.codes if before else []) + codes:
            bench.in_the_kernel(code)


def test_the_order_of_looking_runs(bench: Bench) -> None:
    run_already = {code for cell in cells() for code in cell.codes}
    assert len(order_of_looking()) == 6
    for command in order_of_looking():
        if command not in run_already:
            bench.in_a_terminal(command)


def test_what_is_not_run_stands_on_the_sheet() -> None:
    codes = [code for cell in cells() for code in cell.codes]
    assert set(NOT_RUN) <= set(codes)
    assert len(codes) > 80


@pytest.mark.skipif(not CHROMIUM, reason="it is printed by chromium")
def test_it_is_one_page() -> None:
    assert pages(pdf()) == 1
