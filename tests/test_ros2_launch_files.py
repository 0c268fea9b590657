"""`ros2 launch` before anything runs: finding launch files, their arguments, --show-args, --print, errors."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from course_kit.cli.launching import output
from course_kit.cli.ros2.line_completion import complete
from tests.ros2_launches import IMPORTS, Prefix, RunningGroup


@pytest.fixture
def prefix(tmp_path: Path) -> Prefix:
    prefix = Prefix(tmp_path / "install")
    prefix.launch_file(
        "demo",
        "demo.launch.py",
        """
        DeclareLaunchArgument("speed", default_value=["1", EnvironmentVariable("X", default_value="5")]),
        DeclareLaunchArgument("mode", default_value="slow", description="How to drive", choices=["slow", "fast"]),
        GroupAction([DeclareLaunchArgument("where", description="The place.")], condition=IfCondition("false")),
        LogInfo(msg=["speed ", LaunchConfiguration("speed")]),
    """,
    )
    return prefix


def ended(prefix: Prefix, *words: str | Path, status: int = 0) -> list[str]:
    with RunningGroup("launch", *words, environment=prefix.environment) as running:
        assert running.end().status == status, running.text
        return running.lines


def broken(prefix: Prefix, text: str, name: str = "bad.launch.py") -> list[str]:
    path = prefix.folder / name
    path.write_text(text)
    lines = ended(prefix, path, status=1)
    assert lines[1] == "[INFO] [launch]: Default logging verbosity is set to INFO"
    return lines[2:]


def test_a_file_is_found_by_its_package_or_path(prefix: Prefix) -> None:
    path = prefix.package("demo") / "demo.launch.py"
    for words in (("demo", "demo.launch.py", "speed:=2"), (str(path), "speed:=1", "speed:=2")):
        assert ended(prefix, *words)[2:] == ["[INFO] [launch.user]: speed 2"]


def test_arguments_are_shown(prefix: Prefix) -> None:
    assert ended(prefix, "demo", "demo.launch.py", "--show-args") == [
        "Arguments (pass arguments as '<name>:=<value>'):",
        "",
        "    'speed':",
        "        no description given",
        "        (default: '1' + EnvVar('X'))",
        "",
        "    'mode':",
        "        How to drive. Valid choices are: ['slow', 'fast']",
        "        (default: 'slow')",
        "",
        "    'where':*",
        "        The place.",
        "",
        "* argument(s) which are only used if specific conditions occur",
    ]


def test_the_description_is_printed(prefix: Prefix) -> None:
    lines = ended(prefix, "demo", "demo.launch.py", "-p")
    assert lines[0].startswith("<launch.launch_description.LaunchDescription object at 0x")
    assert lines[1].startswith("├── Action('<launch.actions.declare_launch_argument.DeclareLaunchArgument object at 0x")
    assert lines[-1] == "└── LogInfo('speed ' + LaunchConfig('speed'))"


def test_unknown_packages_and_files_are_told(prefix: Prefix) -> None:
    assert ended(prefix, "dmo", "demo.launch.py", status=1)[0].startswith(
        "Package 'dmo' not found: \"package 'dmo' not found, searching: ['"
    )
    share = prefix.package("demo")
    assert ended(prefix, "demo", "demo.lunch.py", status=1) == [
        f"file 'demo.lunch.py' was not found in the share directory of package 'demo' which is at '{share}'",
        "Did you mean demo.launch.py?",
    ]
    assert ended(prefix, "demo", status=1) == ["No launch file supplied", "demo has: demo.launch.py"]
    assert ended(prefix, "demo", "demo.launch.py", "speed=2", status=1) == [
        "malformed launch argument 'speed=2', expected format '<name>:=<value>'"
    ]


def test_arguments_are_checked(prefix: Prefix) -> None:
    lines = ended(prefix, "demo", "demo.launch.py", "mode:=odd", status=1)
    reason = "mode:=odd is none of the choices ['slow', 'fast']"
    assert lines[-1] == f"[ERROR] [launch]: Caught exception in launch (see debug for traceback): {reason}"
    prefix.launch_file("demo", "needy.launch.py", 'DeclareLaunchArgument("name", description="whose")')
    assert ended(prefix, "demo", "needy.launch.py", status=1)[-1] == (
        "[ERROR] [launch]: Caught exception in launch (see debug for traceback): Included launch description missing "
        "required argument 'name' (description: 'whose'), given: []"
    )


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("from launch.actions import ForLoop", "launch.actions.ForLoop"),
        ("from launch_ros.actions import ComposableNodeContainer", "launch_ros.actions.ComposableNodeContainer"),
        ("from launch_ros.descriptions import ComposableNode", "launch_ros.descriptions.ComposableNode"),
        ("import launch.frontend", "launch.frontend"),
        ("import launch\nlaunch.actions.ForLoop()", "launch.actions.ForLoop"),
        ("import launch_testing", "launch_testing"),
        (IMPORTS + "Node(executable='x', sigfoo=1)])", "Node does not know the argument 'sigfoo'"),
    ],
)
def test_what_needs_the_real_launch_is_named_in_one_line(prefix: Prefix, text: str, name: str) -> None:
    (line,) = broken(prefix, text)
    assert line.startswith(f"[ERROR] [launch]: Caught exception in launch (see debug for traceback): {name} ")
    assert "needs the real `ros2 launch`" in line


def test_tab_offers_packages_and_launch_files(prefix: Prefix, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AMENT_PREFIX_PATH", prefix.environment["AMENT_PREFIX_PATH"])
    monkeypatch.chdir(prefix.package("demo"))
    assert complete("launch demo d") == ["demo.launch.py"]
    assert complete("launch dem") == ["demo", "demo.launch.py"]


def test_every_name_that_is_covered_can_be_imported() -> None:
    code = """if True:
        from importlib import import_module
        from course_kit.cli.launching import stand_ins
        stand_ins.install()
        for module in stand_ins.COVERED:
            for name in import_module(module).__all__:
                exec(f"from {module} import {name}")
                print(module, name)
    """
    names = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.splitlines()
    assert {"launch.actions TimerAction", "launch.utilities perform_substitutions", "launch_ros.actions Node"} < {
        *names
    }


def test_a_slip_of_the_pen_gets_a_suggestion(prefix: Prefix) -> None:
    (line,) = broken(prefix, "from launch.actions import DeclareLaunchArgumnet")
    assert "did you mean DeclareLaunchArgument?" in line


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("nonsense", "NameError: name 'nonsense' is not defined"),
        ("x = 1", "has no function generate_launch_description()"),
        ("def generate_launch_description(): pass", "generate_launch_description() returned NoneType"),
        ("import not_there", "ModuleNotFoundError: No module named 'not_there'"),
    ],
)
def test_a_broken_file_is_told_as_the_real_one_tells_it(prefix: Prefix, text: str, reason: str) -> None:
    lines = broken(prefix, text)
    assert lines[0].endswith("Caught multiple exceptions when trying to load file of format [py]:")
    assert reason in lines[1]
    assert lines[2] == (
        " - InvalidFrontendLaunchFileError: The launch file may have a syntax error, or its format is unknown"
    )


@pytest.mark.parametrize(
    ("entity", "reason"),
    [
        ('LogInfo(msg=LaunchConfiguration("nope"))', "nothing has set the launch configuration 'nope'"),
        ('LogInfo(msg=EnvironmentVariable("NOPE"))', "the environment has no variable 'NOPE'"),
        ('LogInfo(msg="", condition=IfCondition("perhaps"))', "a condition is true, 1, false or 0"),
        ('LogInfo(msg=Command("false"))', "`false` ended with status 1"),
        ('Node(package="nope", executable="x")', "\"package 'nope' not found, searching: ["),
        ('Node(package="demo", executable="x")', "no executable 'x' is in '"),
        ('Node(executable="true", name="a b")', "Invalid node name"),
        ('Node(executable="true", parameters=[{"a": [1, "b"]}])', "the items of a parameter are of one type"),
        (
            'Node(executable="true", parameters=[{"a": {"b": Command("echo b: c: d")}}])',
            "value of parameter a.b is no YAML",
        ),
    ],
)
def test_what_fails_while_it_runs_is_one_line(prefix: Prefix, entity: str, reason: str) -> None:
    lines = broken(prefix, f"{IMPORTS}{entity}])")
    assert reason in lines[-1 if "Invalid" not in reason else 1]
    assert not any("Traceback" in line for line in lines)


def test_debug_shows_the_traceback(prefix: Prefix) -> None:
    path = prefix.folder / "bad.launch.py"
    path.write_text("def generate_launch_description():\n    nonsense\n")
    lines = ended(prefix, path, "-d", status=1)
    assert "[INFO] [launch]: Default logging verbosity is set to DEBUG" in lines
    assert f'  File "{path}", line 2, in generate_launch_description' in lines


def test_a_log_file_on_a_full_disk_is_given_up_with_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "full.log").symlink_to("/dev/full")
    monkeypatch.setattr(output, "launch_folder", lambda: tmp_path)
    for _ in range(3):
        output._log("full.log", "a line")
    (said,) = capsys.readouterr().err.splitlines()
    assert said.startswith("cannot write full.log any more: No space left on device. Make room")
