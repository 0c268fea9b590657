"""Cheats over ROS: false nodes, other processes and domains, answers by heart, programs that nobody built."""

from __future__ import annotations

from tests.cheats.cheat import EMPTY, Cheat, wrong
from tests.exercises.actions.actions_1_face_west import FACE_WEST
from tests.exercises.chapter import changed
from tests.exercises.services.services_1_lamp import LAMP
from tests.exercises.workspace.cells import PREPARE
from tests.exercises.workspace.workspace_1_greeter import BY_HAND, EDITED_INSTALLED, GREETER, SHELL_SCRIPT

# Answers to what was drawn, by heart, and false nodes: those that the exercises are tested with.
KNOWN = {
    "setup-1": ["elsewhere"],
    "setup-3": ["false_poses"],
    "topics-2": ["constant", "class_counts"],
    "topics-4": ["killed"],
    "services-1": ["replayed"],
    "services-2": ["by_number"],
    "services-4": ["ignores_b"],
    "actions-1": ["teleports"],
    "actions-2": ["order_by_heart"],
    "debugging-6": ["four_publishers"],
}
HELPER = f"""
import rclpy, sys
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
rclpy.init(domain_id=int(sys.argv[1]))
{LAMP.replace("lamp = run(Lamp)", "")}
class Told(Lamp):
    def switch(self, *asked):
        response = super().switch(*asked)
        open("state", "w").write(str(self.is_on))
        return response

executor = SingleThreadedExecutor()
for node in (Told(), *(Node(name) for name in sys.argv[2:])):
    executor.add_node(node)
open("state", "w").write("False")
print("ready", flush=True)
try:
    executor.spin()
finally:
    rclpy.try_shutdown()
"""
# Starts the helper when the checker has a node made, in the domain that it does so in, and reads what the helper has.
WITH_HELPER = f"""
import subprocess, sys
from course_kit.exercises.in_notebook import answer_host
open("helper.py", "w").write({HELPER!r})
plain, helpers = answer_host.obey, []

def obey(order, names, timeout):
    if order["do"] == "start":
        for earlier in helpers:
            earlier.send_signal(2)
            earlier.wait()
        words = [sys.executable, "helper.py", str(order["domain"]), *names_of(order)]
        helpers.append(subprocess.Popen(words, stdout=subprocess.PIPE, text=True))
        helpers[-1].stdout.readline()
    return {{"value": open("state").read() == "True"}} if order["do"] == "read" else plain(order, names, timeout)

answer_host.obey = obey
"""
# What the class does only where a condition holds.
ONLY_IF = changed(
    LAMP,
    ("        self.service = self.create_service", "        if CONDITION:\n            self.create_service"),
    ("lamp = run(Lamp)\n", ""),
)
SECOND_NODE = """
import rclpy, threading
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from std_srvs.srv import SetBool

class Lamp(Node):
    is_on = False

    def __init__(self):
        super().__init__("lamp")
        own = Context()
        own.init(domain_id=DOMAIN)
        self.second = rclpy.create_node("lamp", context=own)
        self.second.create_service(SetBool, "lamp", self.switch)
        executor = SingleThreadedExecutor(context=own)
        executor.add_node(self.second)
        threading.Thread(target=executor.spin, daemon=True).start()

    def switch(self, request, response):
        response.success, self.is_on = request.data != self.is_on, request.data
        response.message = "on" if self.is_on else "off"
        return response
"""
OWN_TURTLE = (
    changed(
        FACE_WEST,
        ("import math\n", "import math\nfrom rclpy.action import ActionServer\n"),
        (
            "        self.remaining, self.delta = None, None\n",
            "        self.remaining, self.delta = None, None\n"
            "        self.false = Node('turtlesim')\n"
            "        self.server = ActionServer(self.false, RotateAbsolute, 'turtle1/rotate_absolute', self.turn)\n",
        ),
    )
    + """
    def turn(self, goal):
        goal.succeed()
        return RotateAbsolute.Result(delta=1.0)
"""
)
AT_BUILD = """
path.write_text('''
try:
    open("/run/grading/job/found.jsonl", "a").write("{}"); print("ESCAPED")
except OSError:
    pass
''' + path.read_text())
"""
CHEATS = [
    Cheat(
        f"{exercise}_{each.name}",
        exercise,
        "Answer what is asked as if it were known, or put something false in place of it.",
        each.source,
        points=each.points,
        timeout=60.0,
        by_default=name == "replayed",
    )
    for exercise, names in KNOWN.items()
    for name in names
    for each in [wrong(exercise, name)]
]
CHEATS += [
    Cheat(
        "helper",
        "services-1",
        "Have a process beside an empty class serve, in the checker's own domain.",
        f"names_of = lambda order: []\n{WITH_HELPER}{EMPTY}",
    ),
    Cheat(  # Its first lamp is taken for the answer; its second one is not, for it is another process.
        "helper_with_the_keepers_name",
        "services-1",
        "Have that process have the hidden node by which the checker knows the answer's participant.",
        "names_of = lambda order: [order['keeper']]\n"
        + WITH_HELPER
        + "quiet = answer_host.quiet_node\nanswer_host.quiet_node = lambda name, context: quiet('_other', context)\n"
        + EMPTY,
    ),
    Cheat(
        "only_on_the_stage",
        "services-1",
        "Do what is asked only where the domain is one of a checker.",
        ONLY_IF.replace(
            "CONDITION", "self.context.get_domain_id() >= 200 or int(os.environ['ROS_DOMAIN_ID']) >= 200"
        ).replace("\nclass Lamp", "\nimport os\nclass Lamp"),
    ),
    Cheat(
        "only_beside_the_checker",
        "services-1",
        "Do what is asked only where hidden nodes are that no `ros2` command has.",
        ONLY_IF.replace("CONDITION", "self.sees_the_checker()")
        + """
    def sees_the_checker(self):
        import time
        for _ in range(20):
            if any(name[0] == "_" and not name.startswith("_ros2cli_") for name in self.get_node_names()):
                return True
            time.sleep(0.05)
        return False
""",
    ),
    *(
        Cheat(
            f"second_node_{name}",
            "services-1",
            "Have a second node in a context of its own serve, beside one that does nothing.",
            SECOND_NODE.replace("DOMAIN", domain),
        )
        for name, domain in {"elsewhere": "7", "on_the_stage": "215"}.items()
    ),
    Cheat(
        "own_turtle",
        "actions-1",
        "Take the name of the checker's simulator, and turn nothing.",
        OWN_TURTLE,
    ),
    Cheat(
        "no_class",
        "services-1",
        "Have something that is no node's class made: a function, a class that is derived from all.",
        "class Kind(type):\n    __subclasscheck__ = lambda *a: True\n    mro = lambda cls: [cls, object]\n"
        "class Lamp(metaclass=Kind):\n    is_on = False\n    executor = None\n"
        "    get_fully_qualified_name = lambda self: '/lamp'\n",
    ),
]
BUILT = [
    ("by_hand", BY_HAND, 0, "Make install/ by hand, with a false `ros2` on the PATH of its set-up script."),
    ("shell_script", SHELL_SCRIPT, 1, "Have the program that is installed be a script that says what the check wants."),
    ("edited_installed", EDITED_INSTALLED, 1, "Edit what was built."),
]
CHEATS += [
    Cheat(f"workspace_{name}", "workspace-1", tries, f"{PREPARE}\n{source}", points=points, timeout=60.0)
    for name, source, points, tries in BUILT
]
CHEATS += [
    Cheat(
        "false_programs",
        "workspace-1",
        "Put a false `ros2`, `colcon` and Python on PATH, and a start-up script.",
        "import os\nos.makedirs('false', exist_ok=True)\n"
        "for name in ('ros2', 'colcon', 'python3', 'python', 'bwrap', 'prlimit', 'env'):\n"
        "    open(f'false/{name}', 'w').write('#!/bin/sh\\necho Hi from greeter.\\n')\n"
        "    os.chmod(f'false/{name}', 0o755)\n"
        "os.environ['PATH'] = os.path.abspath('false') + ':' + os.environ['PATH']\n"
        "os.environ['BASH_ENV'] = os.environ['ENV'] = os.path.abspath('false/ros2')\n"
        "made = ws.src / 'greeter'; made.mkdir(parents=True)\n"
        "(made / 'package.xml').write_text('<package format=\"3\"><name>greeter</name><export>'\n"
        "                                  '<build_type>ament_python</build_type></export></package>')\n",
        timeout=60.0,
    ),
    Cheat(
        "links_in_src",
        "workspace-1",
        "Have the checker read files that are links, a FIFO, and a device.",
        "import os\nmade = ws.src / 'greeter'; made.mkdir(parents=True)\n"
        "share = ws.install / 'greeter/share/greeter'; share.mkdir(parents=True)\n"
        "(made / 'package.xml').symlink_to('/run/grading/job/job.json')\nos.mkfifo(share / 'package.xml')\n"
        "index = ws.install / 'greeter/share/ament_index/resource_index/packages'; index.mkdir(parents=True)\n"
        "(index / 'greeter').touch(); (made / 'setup.py').symlink_to('/dev/zero')\n"
        "(ws.install / '.colcon_install_layout').unlink(missing_ok=True)\n"
        "os.mkfifo(ws.install / '.colcon_install_layout')\n",
        timeout=60.0,
    ),
    Cheat(
        "code_at_build",
        "workspace-1",
        "Write down points while setup.py runs; the package itself is right.",
        changed(
            f"{PREPARE}{GREETER}",
            ('build("greeter")', f"path = ws.src / 'greeter/setup.py'\n{AT_BUILD}build('greeter')"),
        ),
        points=2,
        timeout=60.0,
    ),
    Cheat(
        "modules_in_the_way",
        "workspace-1",
        "Hand in modules with the names of the course's, of rclpy and of Python's start; nothing else is begun.",
        "",
        workspace={
            **{f"{name}.py": "import os; os._exit(0)\n" for name in ("course_kit", "rclpy", "sitecustomize")},
            **{f"greeter/{name}.py": "import os; os._exit(0)\n" for name in ("course_kit", "conftest", "setup")},
            "greeter/package.xml": "<package format='3'><name>greeter</name></package>",
            "conftest.py": "import os; os._exit(0)\n",
        },
        timeout=60.0,
    ),
]
