"""Answers to workspace-3: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, solved, worked
from tests.exercises.workspace.cells import PYTHON
from tests.exercises.workspace.workspace_2_louder import LOUD_PY

ROOMS_PY = "\n" + solved("workspace-3").files["ros2_ws/src/greeter/launch/rooms.launch.py"]

WITH_LOUD = f"fresh('greeter', {PYTHON}, programs=['loud'], files={{'greeter/loud.py': {LOUD_PY!r}}})"


def rooms(text: str = ROOMS_PY, after: str = "", more: dict[str, str] | None = None) -> str:
    """The cell that makes greeter with loud and a launch file, and builds it."""
    files = {"greeter/loud.py": LOUD_PY, "launch/rooms.launch.py": text, **(more or {})}
    return f"""
fresh("greeter", {PYTHON}, programs=["loud"], files={files!r})
{after}
build("greeter")
"""


NOT_INSTALLED = """
setup_py = ws.src / "greeter/setup.py"
setup_py.write_text("".join(l for l in setup_py.read_text().splitlines(True) if "'/launch'" not in l))
"""
SWAPPED_ROOMS = changed(ROOMS_PY, ('room("kitchen", [])', 'room("kitchen", [("chatter", "/attic/chatter")])'))
SWAPPED_WORDS = changed(
    ROOMS_PY,
    (
        'LaunchConfiguration(name + "_words")',
        'LaunchConfiguration({"kitchen": "attic", "attic": "kitchen"}[name] + "_words")',
    ),
)
GROUPS = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction
from launch.substitutions import LaunchConfiguration, TextSubstitution
from launch_ros.actions import Node, PushRosNamespace, SetRemap
from launch_ros.descriptions import ParameterValue


def generate_launch_description():
    description = LaunchDescription()
    for room in ("kitchen", "attic"):
        description.add_action(DeclareLaunchArgument(f"{room}_words", default_value=TextSubstitution(text="Hello")))
        words = ParameterValue(LaunchConfiguration(f"{room}_words"), value_type=str)
        talker = Node(package="my_first_pkg", executable="talker", name="talker", parameters=[{"words": words}])
        loud = [Node(package="greeter", executable="loud", output="screen")]
        if room == "attic":
            loud.insert(0, SetRemap("chatter", "/kitchen/chatter"))
        description.add_action(GroupAction([PushRosNamespace(room), talker, GroupAction(loud)]))
    return description
"""
INCLUDES = """
import os

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, OpaqueFunction
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node


def talkers(context):
    said = context.launch_configurations
    return [
        Node(package="my_first_pkg", executable="talker", namespace=room, parameters=[{"words": said[f"{room}_words"]}])
        for room in ("attic", "kitchen")
    ]


def generate_launch_description():
    louds = PythonLaunchDescriptionSource(os.path.join(os.path.dirname(__file__), "louds.launch.py"))
    arguments = [DeclareLaunchArgument("attic_words"), DeclareLaunchArgument("kitchen_words")]
    return LaunchDescription([*arguments, IncludeLaunchDescription(louds), OpaqueFunction(function=talkers)])
"""
LOUDS = """
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    louds = [("/kitchen", []), ("/attic", [("/attic/chatter", "/kitchen/chatter")])]
    return LaunchDescription([
        Node(package="greeter", executable="loud", namespace=where, remappings=names) for where, names in louds
    ])
"""


ANSWERS = Answers(
    "workspace-3",
    3,
    f"{WITH_LOUD}\n{worked('workspace-3')}",
    [
        Wrong("not_installed", rooms(after=NOT_INSTALLED), 0, "`data_files` in setup.py"),
        Wrong(
            "no_namespace",
            rooms(changed(ROOMS_PY, ('"loud", namespace=name,', '"loud",'))),
            0,
            "There is no /kitchen/loud, /attic/loud",
        ),
        Wrong(
            "no_remapping",
            rooms(changed(ROOMS_PY, ('[("chatter", "/kitchen/chatter")]', "[]"))),
            2,
            "to be remapped to `/kitchen/chatter`",
        ),
        Wrong(
            "relative",
            rooms(changed(ROOMS_PY, ('"/kitchen/chatter"', '"kitchen/chatter"'))),
            2,
            "with a slash, or the name stays in the attic",
        ),
        Wrong(
            "words",
            rooms(changed(ROOMS_PY, ('{"words": LaunchConfiguration(name + "_words")}', '{"words": "Bones"}'))),
            2,
            "that of the attic `Bones`",
        ),
        Wrong("swapped_rooms", rooms(SWAPPED_ROOMS), 2, "and only of that, is to be remapped"),
        Wrong("swapped_words", rooms(SWAPPED_WORDS), 2, "LaunchConfiguration(…)"),
    ],
    {"groups": rooms(GROUPS), "includes": rooms(INCLUDES, more={"launch/louds.launch.py": LOUDS})},
)
