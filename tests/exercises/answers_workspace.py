"""Answers to chapter 2's exercises: one that is right, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.answers_topics import changed
from tests.exercises.chapter import Answers, Wrong

# The cells of the chapter that its exercises stand on, and what the cells between them would have done.
CELLS = (
    "workspace-make",
    "workspace-package",
    "workspace-package-files",
    "workspace-nodes-spin",
    "workspace-nodes-talker",
    "workspace-register-lines",
    "workspace-parameters-talker",
)
PREPARE = r'''
import shutil, subprocess
from rclpy.node import Node

ws.build("--packages-select", "my_first_pkg")
ws.use()


def fresh(name, *options, programs=(), files={}):
    """Make a package anew, with these programs and files."""
    for part in ("src", "build", "install"):
        shutil.rmtree(ws.folder / part / name, ignore_errors=True)
    command = ["ros2", "pkg", "create", name, "--license", "Apache-2.0", *options]
    subprocess.run(command, cwd=ws.src, check=True, capture_output=True)
    made, setup_py = ws.src / name, ws.src / name / "setup.py"
    for program in programs:
        add_line(setup_py, "'console_scripts': [", f"            '{program} = {name}.{program}:main',")
    if setup_py.is_file():
        for folder in ("launch", "config"):
            line = f"        ('share/' + package_name + '/{folder}', __import__('glob').glob('{folder}/*')),"
            add_line(setup_py, "        ('share/' + package_name, ['package.xml']),", line)
    for path, text in files.items():
        (made / path).parent.mkdir(exist_ok=True)
        (made / path).write_text(text)


def build(*names):
    ws.build("--packages-select", *names)
    ws.use()


def interfaces(battery, recharge):
    """Build robot_interfaces with these definitions, unless it is built with them."""
    files = {"msg/Battery.msg": battery, "srv/Recharge.srv": recharge}
    made = ws.src / "robot_interfaces"
    if (ws.install / "robot_interfaces").is_dir() and all((made / f).read_text() == t for f, t in files.items()):
        return
    lines = "find_package(rosidl_default_generators REQUIRED)\nrosidl_generate_interfaces(${PROJECT_NAME}\n"
    lines += '  "msg/Battery.msg" "srv/Recharge.srv")\nament_export_dependencies(rosidl_default_runtime)\n'
    fresh("robot_interfaces", "--build-type", "ament_cmake", files=files)
    add_line(made / "CMakeLists.txt", "find_package(ament_cmake REQUIRED)", lines)
    group = "  <buildtool_depend>rosidl_default_generators</buildtool_depend>\n"
    group += "  <member_of_group>rosidl_interface_packages</member_of_group>"
    add_line(made / "package.xml", "  <buildtool_depend>ament_cmake</buildtool_depend>", group)
    build("robot_interfaces")
'''

PYTHON = '"--build-type", "ament_python", "--node-name", "greet"'

GREETER = f"""
fresh("greeter", {PYTHON})
build("greeter")
"""

LOUD_PY = """
from my_first_pkg.spin import spin
from rclpy.node import Node
from std_msgs.msg import String


class Loud(Node):
    def __init__(self):
        super().__init__("loud")
        self.declare_parameter("mark", "!")
        self.publisher = self.create_publisher(String, "loud", 10)
        self.create_subscription(String, "chatter", self.on_words, 10)

    def on_words(self, message):
        mark = self.get_parameter("mark").value
        self.publisher.publish(String(data=message.data.upper() + mark))


def main():
    spin(Loud)
"""


def loud(text: str = LOUD_PY, programs: str = '["loud"]', after: str = "") -> str:
    """The cell that makes greeter with a file loud.py, builds it, and then does something else."""
    return f"""
fresh("greeter", {PYTHON}, programs={programs}, files={{"greeter/loud.py": {text!r}}})
build("greeter")
{after}
"""


EDITED = """
path = ws.src / "greeter/greeter/loud.py"
path.write_text(path.read_text().replace("mark))", "mark + mark))"))
"""
READ_ONCE = changed(
    LOUD_PY,
    ('self.declare_parameter("mark", "!")', 'self.mark = self.declare_parameter("mark", "!").value'),
    ('mark = self.get_parameter("mark").value', "mark = self.mark"),
)
PLAIN_SPIN = changed(
    LOUD_PY,
    ("from my_first_pkg.spin import spin", "import rclpy"),
    ("    spin(Loud)", "    rclpy.init()\n    rclpy.spin(Loud())\n    rclpy.shutdown()"),
)

ROOMS_PY = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def room(name, remappings):
    words = {"words": LaunchConfiguration(name + "_words")}
    return [
        DeclareLaunchArgument(name + "_words", default_value=name),
        Node(package="my_first_pkg", executable="talker", namespace=name, parameters=[words]),
        Node(package="greeter", executable="loud", namespace=name, remappings=remappings),
    ]


def generate_launch_description():
    return LaunchDescription(room("kitchen", []) + room("attic", [("chatter", "/kitchen/chatter")]))
"""


def rooms(text: str = ROOMS_PY, after: str = "") -> str:
    """The cell that makes greeter with loud and a launch file, and builds it."""
    files = {"greeter/loud.py": LOUD_PY, "launch/rooms.launch.py": text}
    return f"""
fresh("greeter", {PYTHON}, programs=["loud"], files={files!r})
{after}
build("greeter")
"""


NOT_INSTALLED = """
setup_py = ws.src / "greeter/setup.py"
setup_py.write_text("".join(l for l in setup_py.read_text().splitlines(True) if "'/launch'" not in l))
"""

BATTERY = "float32 EMPTY_VOLTAGE=11.0\nfloat32 voltage\nfloat32 percentage  # 0 to 100\nbool charging\n"
RECHARGE = "float32 percentage\n---\nbool accepted\nstring reason\n"


def types(battery: str = BATTERY, recharge: str = RECHARGE) -> str:
    return f"interfaces({battery!r}, {recharge!r})\n"


CHARGER = (
    types()
    + """
from robot_interfaces.msg import Battery
from robot_interfaces.srv import Recharge


class Charger(Node):
    def __init__(self):
        super().__init__("charger")
        self.battery = Battery(voltage=12.5, percentage=100.0)
        self.publisher = self.create_publisher(Battery, "battery", 10)
        self.create_timer(1.0, self.tick)
        self.create_service(Recharge, "recharge", self.recharge)

    def tick(self):
        self.battery.percentage -= 0.5
        self.publisher.publish(self.battery)

    def recharge(self, request, response):
        response.accepted = request.percentage <= 100.0
        if response.accepted:
            self.battery.percentage = request.percentage
        else:
            response.reason = "more than full"
        return response
"""
)

PATROL_PY = """
import math
from geometry_msgs.msg import Twist
from my_first_pkg.spin import spin
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from turtlesim.msg import Pose


class Patrol(Node):
    def __init__(self):
        super().__init__("patrol")
        self.declare_parameter("side", 2.0)
        self.declare_parameter("speed", 1.0)
        self.add_on_set_parameters_callback(self.on_change)
        self.start, self.heading, self.turning = None, 0.0, False
        self.publisher = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 1)

    def on_change(self, parameters):
        if any(one.name == "speed" and one.value <= 0.0 for one in parameters):
            return SetParametersResult(successful=False, reason="it would never arrive")
        return SetParametersResult(successful=True)

    def on_pose(self, pose):
        self.start = self.start or pose
        twist, error = Twist(), math.remainder(self.heading - pose.theta, math.tau)
        if self.turning:
            twist.angular.z = max(-2.0, min(2.0, 4.0 * error))
            if abs(error) < 0.02:
                self.turning, self.start = False, pose
        else:
            twist.linear.x = self.get_parameter("speed").value
            gone = math.dist((pose.x, pose.y), (self.start.x, self.start.y))
            if gone >= self.get_parameter("side").value:
                self.turning, self.heading = True, self.heading + math.pi / 2
        self.publisher.publish(twist)


def main():
    spin(Patrol)
"""
PATROL_LAUNCH = """
from launch import LaunchDescription
from launch.substitutions import PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def room(name):
    yaml = PathJoinSubstitution([FindPackageShare("patrol"), "config", name + ".yaml"])
    return [
        Node(package="turtlesim", executable="turtlesim_node", namespace=name),
        Node(package="patrol", executable="patrol", namespace=name, parameters=[yaml]),
    ]


def generate_launch_description():
    return LaunchDescription(room("one") + room("two"))
"""
YAML = "/**:\n  ros__parameters:\n    side: {side}\n    speed: {speed}\n"


def patrol(code: str = PATROL_PY, launch: str = PATROL_LAUNCH, head: str = "/**:") -> str:
    """The cell that makes and builds the package."""
    files = {
        "patrol/patrol.py": code,
        "launch/patrol.launch.py": launch,
        "config/one.yaml": YAML.format(side=1.0, speed=1.5).replace("/**:", head),
        "config/two.yaml": YAML.format(side=3.0, speed=1.0).replace("/**:", head),
    }
    return f"""
fresh("patrol", "--build-type", "ament_python", programs=["patrol"], files={files!r})
build("patrol")
"""


ANSWERS = [
    Answers(
        "workspace-1",
        2,
        GREETER,
        [
            Wrong("not_built", changed(GREETER, ('build("greeter")\n', "")), 0, "colcon build --packages-select"),
            Wrong(
                "built_in_src",
                changed(
                    GREETER,
                    (
                        'build("greeter")',
                        'subprocess.run(["colcon", "build"], cwd=ws.src, capture_output=True)',
                    ),
                ),
                0,
                "you built in `src`",
            ),
            Wrong(
                "program",
                "for made in ('build', 'install', 'log'): shutil.rmtree(ws.src / made, ignore_errors=True)\n"
                + changed(GREETER, ('"greet")', '"hello")')),
                1,
                "finds hello in greeter",
            ),
            Wrong(
                "build_type",
                changed(GREETER, ('"ament_python"', '"ament_cmake"')),
                0,
                "make it anew with `--build-type ament_python`",
            ),
        ],
    ),
    Answers(
        "workspace-2",
        3,
        loud(),
        [
            Wrong("no_entry_point", loud(programs="[]"), 0, "a line `loud = greeter.module:main`"),
            Wrong("not_built_again", loud(after=EDITED), 0, "src/greeter/greeter/loud.py is newer than"),
            Wrong("read_once", loud(READ_ONCE), 2, "Read the parameter each time"),
            Wrong(
                "not_declared", loud(changed(LOUD_PY, ('        self.declare_parameter("mark", "!")\n', ""))), 0, "mark"
            ),
            Wrong("not_upper", loud(changed(LOUD_PY, (".upper()", ".title()"))), 0, "it said 'Good Morning!'"),
            Wrong("plain_spin", loud(PLAIN_SPIN), 2, "Ctrl-C ended it with status"),
        ],
    ),
    Answers(
        "workspace-3",
        3,
        rooms(),
        [
            Wrong("not_installed", rooms(after=NOT_INSTALLED), 0, "`data_files` in setup.py"),
            Wrong(
                "no_namespace",
                rooms(changed(ROOMS_PY, ('"loud", namespace=name,', '"loud",'))),
                0,
                "There is no /kitchen/loud, /attic/loud",
            ),
            Wrong("no_remapping", rooms(changed(ROOMS_PY, ('[("chatter", "/kitchen/chatter")]', "[]"))), 2, "`DUST`"),
            Wrong(
                "relative",
                rooms(changed(ROOMS_PY, ('"/kitchen/chatter"', '"kitchen/chatter"'))),
                2,
                "with a slash, or the name stays in the attic",
            ),
            Wrong(
                "words",
                rooms(changed(ROOMS_PY, ('{"words": LaunchConfiguration(name + "_words")}', '{"words": "Soup"}'))),
                2,
                "that of the attic `Soup`",
            ),
        ],
    ),
    Answers(
        "workspace-4",
        4,
        CHARGER,
        [
            Wrong(
                "definitions",
                types(BATTERY.replace("float32 percentage", "int32 percentage"), RECHARGE.replace("accepted", "ok")),
                0,
                "It says: float32 EMPTY_VOLTAGE=11.0 / float32 voltage / int32 percentage",
            ),
            Wrong("not_less", changed(CHARGER, ("percentage -= 0.5", "percentage -= 0.0")), 3, "less than before"),
            Wrong(
                "accepts_all", changed(CHARGER, ("request.percentage <= 100.0", "True")), 3, "accepted=True, reason=''"
            ),
            Wrong(
                "topic_type",
                changed(
                    CHARGER,
                    ('(Battery, "battery", 10)', '(String, "battery", 10)'),
                    ("from robot_interfaces.srv", "from std_msgs.msg import String\nfrom robot_interfaces.srv"),
                    ("publish(self.battery)", "publish(String())"),
                ),
                2,
                "Its type is std_msgs/msg/String",
            ),
            Wrong("no_reason", changed(CHARGER, ('"more than full"', '""')), 3, "What is refused has a reason"),
        ],
    ),
    Answers(
        "workspace-5",
        5,
        patrol(),
        [
            Wrong(
                "triangle",
                patrol(changed(PATROL_PY, ("self.heading + math.pi / 2", "self.heading + math.tau / 3"))),
                3,
                "then a turn by 90°",
            ),
            Wrong(
                "read_once",
                patrol(
                    changed(
                        PATROL_PY,
                        (
                            'self.declare_parameter("side", 2.0)',
                            'self.side = self.declare_parameter("side", 2.0).value',
                        ),
                        ('self.get_parameter("side").value', "self.side"),
                    )
                ),
                4,
                "not in __init__",
            ),
            Wrong(
                "absolute_and_any_speed",
                patrol(
                    changed(
                        PATROL_PY,
                        ('"turtle1/cmd_vel"', '"/turtle1/cmd_vel"'),
                        ('"turtle1/pose"', '"/turtle1/pose"'),
                        ("one.value <= 0.0", "False"),
                    )
                ),
                3,
                "it is -1.0",
            ),
            Wrong("file_for_another", patrol(head="patrol:"), 4, "its first line names"),
        ],
    ),
]
