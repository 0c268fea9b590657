"""`ros2 launch`: launch files run real nodes in real processes, and what they describe happens."""

from __future__ import annotations

import re
import time
from pathlib import Path

import pytest
import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from turtlesim.msg import Pose

from tests.ros2_command import TIMEOUT
from tests.ros2_launches import Prefix, RunningGroup

STARTED = r"process started with pid"


@pytest.fixture
def prefix(tmp_path: Path) -> Prefix:
    prefix = Prefix(tmp_path / "install")
    prefix.package("demo")
    prefix.node("demo", "reporter")
    return prefix


def launch(prefix: Prefix, entities: str, *arguments: str) -> RunningGroup:
    prefix.launch_file("demo", "demo.launch.py", entities)
    return RunningGroup("launch", "demo", "demo.launch.py", *arguments, environment=prefix.environment)


def drive_until_moved(command: str, pose: str) -> None:
    """Drive one turtle until another one has moved."""
    context = rclpy.context.Context()
    rclpy.init(context=context)
    node = Node("driver", context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    poses: list[Pose] = []
    node.create_subscription(Pose, pose, poses.append, 10)
    publisher = node.create_publisher(Twist, command, 10)
    deadline = time.monotonic() + TIMEOUT
    while not (poses and poses[-1].x > 6.0):
        assert time.monotonic() < deadline, f"{pose} did not move"
        publisher.publish(Twist(linear=Vector3(x=2.0)))
        executor.spin_once(timeout_sec=0.05)
    node.destroy_node()
    rclpy.shutdown(context=context)


def without_ids(lines: list[str]) -> list[str]:
    return [re.sub(r"pid( \[?)\d+", r"pid\1N", line) for line in lines]


def test_output_is_that_of_the_real_command(prefix: Prefix) -> None:
    entities = """
        python("import sys; print('out'); print('err', file=sys.stderr)", name="first"),
        RegisterEventHandler(OnProcessExit(on_exit=[
            ExecuteProcess(cmd=["sh", "-c", "echo unseen; echo seen >&2; exit 3"])
        ], handle_once=True)),
    """
    with launch(prefix, entities) as running:
        assert running.end().status == 0
        logs = running.lines[0].removeprefix("[INFO] [launch]: All log files can be found below ")
        lines = without_ids(running.lines[1:])
        assert sorted(lines[2:4]) == ["[first-1] err", "[first-1] out"]
        del lines[2:4]
        assert lines == [
            "[INFO] [launch]: Default logging verbosity is set to INFO",
            "[INFO] [first-1]: process started with pid [N]",
            "[INFO] [first-1]: process has finished cleanly [pid N]",
            "[INFO] [sh-2]: process started with pid [N]",
            "[sh-2] seen",
            "[ERROR] [sh-2]: process has died [pid N, exit code 3, cmd 'sh -c echo unseen; echo seen >&2; exit 3'].",
        ]
        assert Path(logs).parent == prefix.folder / "log"
        assert (prefix.folder / "log/latest").resolve() == Path(logs)
        log = Path(logs, "launch.log").read_text()
        assert "[sh-2] unseen\n" in log
        assert re.search(r"^\d+\.\d{7} \[INFO\] \[first-1\]: process started", log, re.MULTILINE)


def test_arguments_name_namespace_parameters_and_remappings_reach_the_node(prefix: Prefix) -> None:
    (prefix.package("demo") / "gains.yaml").write_text("/**:\n  ros__parameters:\n    gain: 0.25\n    speed: 1.0\n")
    entities = """
        DeclareLaunchArgument("speed", default_value="1.5"),
        DeclareLaunchArgument("label", default_value="7"),
        Node(
            package="demo", executable="reporter", name="driver", namespace="robot1", output="screen",
            parameters=[
                PathJoinSubstitution([FindPackageShare("demo"), "gains.yaml"]),
                {"speed": LaunchConfiguration("speed"), "is_fast": True, "rates": [1, 2.5], "names": ["a", "b"],
                 "arm": {"length": 2, "tool": {"name": "grip"}},
                 "label": ParameterValue(LaunchConfiguration("label"), value_type=str)},
            ],
            remappings=[("chatter", ["/from_", TextSubstitution(text="robot")])],
            arguments=["--mode", "auto"], ros_arguments=["--log-level", "warn"],
            additional_env={"COLOUR": "green"}, cwd=FindPackageShare("demo"),
        ),
    """
    with launch(prefix, entities, "speed:=2.5") as running:
        (report,) = running.reports()
        assert report["name"] == "/robot1/driver"
        own = ("use_sim_time", "start_type_description_service")
        assert {name: value for name, value in report["parameters"].items() if name not in own} == {
            "gain": 0.25,
            "speed": 2.5,
            "is_fast": True,
            "rates": [1.0, 2.5],
            "names": ["a", "b"],
            "arm.length": 2,
            "arm.tool.name": "grip",
            "label": "7",
        }
        assert report["chatter"] == "/from_robot"
        assert report["arguments"] == ["--mode", "auto"]
        assert report["colour"] == "green"
        assert report["folder"] == str(prefix.package("demo"))


def test_group_include_and_environment_have_their_scopes(prefix: Prefix) -> None:
    prefix.launch_file(
        "demo",
        "one.launch.py",
        """
        DeclareLaunchArgument("name", description="of the node"),
        Node(package="demo", executable="reporter", name=LaunchConfiguration("name"), output="screen"),
        LogInfo(msg=["in ", ThisLaunchFileDir()]),
    """,
    )
    include = 'IncludeLaunchDescription(PythonLaunchDescriptionSource([ThisLaunchFileDir(), "/one.launch.py"]), '
    entities = f"""
        GroupAction([
            PushRosNamespace("outer"),
            SetEnvironmentVariable("COLOUR", "red"),
            GroupAction([PushRosNamespace("inner"), {include} launch_arguments={{"name": "a"}}.items())]),
            {include} launch_arguments=[("name", "b")]),
        ]),
        {include} launch_arguments={{"name": "c"}}.items()),
        GroupAction([{include} launch_arguments={{"name": "no"}}.items())], condition=IfCondition("false")),
        Node(package="demo", executable="reporter", name="last", output="screen",
             condition=UnlessCondition(PythonExpression(["'", EnvironmentVariable("HOME"), "' == ''"]))),
    """
    with launch(prefix, entities) as running:
        reports = {report["name"]: report["colour"] for report in running.reports(4)}
        assert reports == {"/outer/inner/a": "red", "/outer/b": "red", "/c": None, "/last": None}
        assert running.text.count(f"[INFO] [launch.user]: in {prefix.package('demo')}\n") == 3


def test_substitutions_give_their_texts(prefix: Prefix) -> None:
    entities = """
        SetLaunchConfiguration("a", "1"),
        LogInfo(msg=["|", TextSubstitution(text="t"), EnvironmentVariable("NOPE", default_value="none")]),
        LogInfo(msg=["|", Command(["echo ", LaunchConfiguration("a")]),
                     PythonExpression([LaunchConfiguration("a"), "+1"])]),
        LogInfo(msg=["|", ThisLaunchFile(), " ", FindPackagePrefix("demo")]),
        LogInfo(msg=["|", EqualsSubstitution(LaunchConfiguration("a"), 1), NotSubstitution("true")]),
        OpaqueFunction(function=lambda context, word: [LogInfo(msg=word + LaunchConfiguration("a").perform(context))],
                       args=["|opaque"]),
    """
    with launch(prefix, entities) as running:
        assert running.end().status == 0
        text = running.text.replace(str(prefix.folder), "P")
        assert [line.partition("|")[2] for line in text.split("[INFO] [launch.user]: ")[1:]] == [
            "tnone\n",
            "1\n2\n",
            "P/share/demo/demo.launch.py P\n",
            "truefalse\n",
            "opaque1",
        ]


def test_event_handlers_and_timers_act_in_turn(prefix: Prefix) -> None:
    entities = """
        first := python("import os; os.write(1, b'working')"),
        RegisterEventHandler(OnProcessStart(target_action=first, on_start=[LogInfo(msg="first started")])),
        RegisterEventHandler(OnProcessExit(target_action=first, on_exit=lambda event, context: [
            LogInfo(msg=f"{event.process_name} gave {event.returncode}"),
            TimerAction(period=0.2, actions=[python("print('second')", name="second")]),
        ])),
        RegisterEventHandler(OnShutdown(on_shutdown=[LogInfo(msg="over")])),
        RegisterEventHandler(OnProcessIO(target_action=first, on_stdout=lambda event: LogInfo(
            msg="heard " + event.text.decode().strip()))),
    """
    with launch(prefix, entities) as running:
        assert running.end().status == 0
        told = [line.removeprefix("[INFO] [launch.user]: ") for line in running.lines if "launch.user" in line]
        assert sorted(told[:2]) == ["first started", "heard working"]
        assert told[2:] == ["child-1 gave 0", "over"]
        assert "[second-2] second" in running.lines


def test_a_process_is_started_again_until_the_launch_ends(prefix: Prefix) -> None:
    entities = """
        python("print('up'); raise SystemExit(1)", respawn=True, respawn_delay=0.05),
        TimerAction(period=60.0, actions=[]),
    """
    with launch(prefix, entities) as running:
        assert len(set(running.pids(3))) == 3
        running.interrupt()
        assert running.end().status == 0


def test_a_required_process_shuts_the_launch_down(prefix: Prefix) -> None:
    entities = """
        Node(package="demo", executable="reporter", output="screen"),
        RegisterEventHandler(OnProcessIO(on_stdout=lambda event: [python("pass", on_exit=Shutdown(reason="done"))]
            if b"name" in event.text else None)),
    """
    with launch(prefix, entities) as running:
        assert running.end().status == 0
        assert "[INFO] [launch]: process[child-2] was required: shutting down launched system" in running.lines
        assert "[INFO] [reporter-1]: sending signal 'SIGINT' to process[reporter-1]" in running.lines
        assert without_ids(running.lines)[-1] == "[INFO] [reporter-1]: process has finished cleanly [pid N]"


@pytest.mark.parametrize(("output", "shown"), [("screen", "oe"), ("log", "e"), ("both", "oe"), ("own_log", "")])
def test_output_goes_where_it_says(prefix: Prefix, output: str, shown: str) -> None:
    entities = f"""python("import sys; print('o'); print('e', file=sys.stderr)", output="{output}")"""
    with launch(prefix, entities) as running:
        assert running.end().status == 0
        assert (
            "".join(sorted((line[-1] for line in running.lines if line.startswith("[child-1]")), reverse=True)) == shown
        )
        logs = prefix.folder / "log/latest"
        logged = re.findall(r"\[child-1\] (.)", (logs / "launch.log").read_text())
        assert sorted(logged) == (["e", "o"] if output in ("log", "both") else [])
        own = (logs / "child-1-stdout.log").read_text() if output == "own_log" else None
        assert own == ("[child-1] o\n" if output == "own_log" else None)


def test_a_log_folder_that_cannot_be_made_keeps_nothing_from_running(prefix: Prefix) -> None:
    (prefix.folder / "file").touch()
    prefix.environment["ROS_LOG_DIR"] = str(prefix.folder / "file/log")
    with launch(prefix, "python(\"print('up')\")") as running:
        assert running.end().status == 0
        assert "[child-1] up" in running.lines
        assert running.text.count("cannot write launch.log: ") == 1


def test_a_terminal_is_emulated(prefix: Prefix) -> None:
    entities = 'Node(package="demo", executable="reporter", output="screen", emulate_tty=True)'
    with launch(prefix, entities) as running:
        assert running.reports()[0]["tty"] is True


def test_a_prefix_goes_before_commands(prefix: Prefix) -> None:
    entities = """
        ExecuteProcess(cmd=["echo", "one"], output="screen"),
        ExecuteProcess(cmd=["printf", "two"], output="screen", prefix="env"),
    """
    with launch(prefix, entities, "--launch-prefix", "echo before", "--launch-prefix-filter", "ech") as running:
        assert running.end().status == 0
        assert {"[echo-1] before echo one", "[env-2] two"} <= set(running.lines)


def test_the_tutorial_s_turtlesim_runs(prefix: Prefix) -> None:
    entities = """
        Node(package="turtlesim", namespace="turtlesim1", executable="turtlesim_node", name="sim"),
        Node(package="turtlesim", namespace="turtlesim2", executable="turtlesim_node", name="sim"),
        Node(package="turtlesim", executable="mimic", name="mimic", remappings=[
            ("/input/pose", "/turtlesim1/turtle1/pose"), ("/output/cmd_vel", "/turtlesim2/turtle1/cmd_vel")]),
    """
    with launch(prefix, entities) as running:
        running.wait_for(r"^\[turtlesim_node-\d\] .*Spawning turtle \[turtle1\]", 2)
        assert len(running.pids(3)) == 3
        drive_until_moved("/turtlesim1/turtle1/cmd_vel", "/turtlesim2/turtle1/pose")
        running.interrupt()
        assert running.end().status == 0
        assert len(running.wait_for("process has finished cleanly", 3)) == 3
