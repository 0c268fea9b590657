"""Workspace: real colcon builds, what sourcing does, built nodes as processes, a student's own interfaces."""

from __future__ import annotations

import contextlib
import io
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from course_kit import Workspace, start, wait_for
from course_kit.base.programs import processes
from course_kit.setup.colcon.colcon_output import Build
from course_kit.setup.colcon.workspaces import BuildError
from course_kit.setup.environment.activation import has_package, sourced_ros
from tests import packages
from tests.course_copy import fresh_environ
from tests.kernel import Kernel
from tests.ros2_launches import is_alive, none_left
from tests.waiting import wait_until

pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.timeout(300),
    pytest.mark.by_turns("builds of packages"),
]
STARTED = 30.0  # seconds until a node of another process is heard


@dataclass
class Built:
    """A workspace with demo_py, demo_interfaces and demo_cpp, and what its build printed."""

    workspace: Workspace
    build: Build
    printed: str


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> Iterator[Built]:
    workspace = Workspace(tmp_path_factory.mktemp("notebooks") / "ros2_ws")
    packages.add_python_package(workspace.src)
    packages.add_interface_package(workspace.src)
    packages.add_cpp_package(workspace.src)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), pytest.MonkeyPatch.context() as patch:
        patch.delenv("PYTHONDONTWRITEBYTECODE", raising=False)  # setuptools would warn of it
        build = workspace.build()
    yield Built(workspace, build, printed.getvalue())
    shutil.rmtree(workspace.folder)


@pytest.fixture
def small(tmp_path) -> Workspace:
    """A workspace with demo_py and demo_cpp, not built."""
    workspace = Workspace(tmp_path / "ros2_ws")
    packages.add_python_package(workspace.src)
    packages.add_cpp_package(workspace.src)
    return workspace


@pytest.fixture(autouse=True)
def ended() -> Iterator[None]:
    yield
    processes.stop_all(patience=1.0)


def test_a_build_prints_what_colcon_prints_and_tells_what_was_built(built):
    lines = built.printed.splitlines()
    assert {"Starting >>> demo_py", "Starting >>> demo_interfaces", "Starting >>> demo_cpp"} < set(lines)
    assert any(line.startswith("Summary: 3 packages finished [") for line in lines)
    assert sorted(built.build.finished) == ["demo_cpp", "demo_interfaces", "demo_py"]
    assert built.build.ok and built.build.failed == {}
    made = {path.name for path in built.workspace.folder.iterdir()}
    assert made == {"src", "build", "install", "log"}


def test_nothing_but_colcons_own_lines_is_printed(built):
    assert [line for line in built.printed.splitlines() if "arning" in line or "said" in line] == []


def test_sourcing_adds_the_packages_and_nothing_else(built):
    changes = built.workspace.changes
    install = built.workspace.install
    assert set(changes["AMENT_PREFIX_PATH"]) == {str(install / name) for name in built.build.finished}
    assert changes["COLCON_PREFIX_PATH"] == [str(install)]
    assert all(Path(entry).is_relative_to(install) for entries in changes.values() for entry in entries)


def test_talker_and_listener_are_processes_that_hear_each_other(built):
    talker = built.workspace.start("ros2 run demo_py talker --ros-args -p words:=Hi")
    listener = built.workspace.start("ros2 run demo_py listener")
    wait_for(lambda: listener.says("I heard: [Hi: "), timeout=STARTED)
    assert talker.stop() == 0
    assert talker.lines[-1] == "talker ends"
    assert listener.is_running and listener.stop() == 0


def test_parameters_come_from_a_file(built, tmp_path):
    (tmp_path / "talker.yaml").write_text("talker:\n  ros__parameters:\n    words: From a file\n")
    built.workspace.start(f"ros2 run demo_py talker --ros-args --params-file {tmp_path / 'talker.yaml'}")
    listener = built.workspace.start("ros2 run demo_py listener")
    wait_for(lambda: listener.says("I heard: [From a file: "), timeout=STARTED)


def test_a_launch_file_is_launched_and_stopped_with_all_its_nodes(built):
    launch = built.workspace.start("ros2 launch demo_py demo.launch.py words:=Launched")
    wait_for(lambda: launch.says("I heard: [Launched: "), timeout=STARTED)
    pids = [int(line.split("[")[-1].rstrip("]")) for line in launch.lines if "process started with pid" in line]
    assert len(pids) == 2 and all(is_alive(pid) for pid in pids)
    assert launch.stop(patience=15.0) == 0
    assert none_left(pids)
    # One end may be no clean one: a Ctrl-C that meets rclpy while it takes a message comes out as a RuntimeError.
    clean = sum("process has finished cleanly" in line for line in launch.lines)
    spoilt = launch.says("RuntimeError: Unable to convert call argument '0' to Python object")
    died = sum("[listener-2]: process has died" in line and "exit code 1," in line for line in launch.lines)
    assert (clean, died) == ((1, 1) if spoilt else (2, 0)), launch.output


def test_not_sourced_the_package_is_not_found(built, monkeypatch):
    for name, value in built.workspace.environment.items():
        monkeypatch.setenv(name, value)  # as in a notebook that uses the workspace
    unsourced = start("ros2 run demo_py talker", environment=built.workspace.unsourced)
    assert wait_for(unsourced, timeout=STARTED) != 0
    assert any("'demo_py' not found" in line for line in unsourced.lines)


def test_a_cpp_executable_runs(built):
    hello = built.workspace.start("ros2 run demo_cpp hello")
    assert wait_for(hello, timeout=STARTED) == 0
    assert hello.lines == ["Hello from C++"]


@pytest.mark.skipif(sourced_ros(os.environ) is not None, reason="apt's ROS 2 has an underlay of its own")
def test_sourcing_in_an_empty_shell_brings_the_whole_course(built):
    program = (
        "from demo_interfaces.msg import Spot; import course_kit, turtlesim.msg, os; "
        "print(Spot(name='x').name, os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'])"
    )
    script = f"source '{built.workspace.install}/setup.bash' && ros2 run demo_cpp hello && python -c \"{program}\""
    clean = {"PATH": "/usr/bin:/bin", "HOME": os.environ.get("HOME", "/")}
    done = subprocess.run(["bash", "-c", script], env=clean, capture_output=True, text=True, timeout=60)
    assert (done.stdout, done.stderr) == ("Hello from C++\nx LOCALHOST\n", "")


@pytest.fixture
def kernel(built) -> Iterator[Kernel]:
    kernel = Kernel()
    try:
        kernel.run(
            "import os, sys\nfrom pathlib import Path\nimport rclpy\nfrom rclpy.node import Node\n"
            "from course_kit import Workspace, run, start, stop, wait_for\n"
            f"ws = Workspace({str(built.workspace.folder)!r})"
        )
        yield kernel
    finally:
        kernel.close()


def test_a_running_kernel_imports_own_interfaces_and_talks_to_a_built_node(kernel):
    missing = kernel.send("import demo_interfaces.msg")
    kernel.finish(missing)
    assert [m["content"]["ename"] for m in kernel.of(missing) if m["msg_type"] == "error"] == ["ModuleNotFoundError"]
    kernel.run("ws.use()")
    kernel.run(
        "from demo_interfaces.msg import Spot\nfrom demo_interfaces.srv import Mark\n"
        "from demo_interfaces.action import Walk\n"
        "class Watcher(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('watcher')\n"
        "        self.spots = []\n"
        "        self.create_subscription(Spot, 'spots', self.spots.append, 10)\n"
        "        self.mark = self.create_client(Mark, 'mark')\n"
        "watcher = run(Watcher)"
    )
    kernel.run("spotter = start('ros2 run demo_py spotter')")  # sourced by use()
    heard = kernel.run("wait_for(lambda: watcher.spots, timeout=30); print(watcher.spots[0].sizes.tolist())", 40)
    assert kernel.text(heard) == "[1.0, 2.0]\n"
    asked = kernel.run(
        "wait_for(watcher.mark.service_is_ready, timeout=30)\n"
        "print(wait_for(watcher.mark.call_async(Mark.Request(spot=Spot(name='goal')))).text)",
        40,
    )
    assert kernel.text(asked) == "goal at 0.0\n"
    kernel.run("from rclpy.action import ActionClient, ActionServer; ActionClient(watcher, Walk, 'walk')")
    shown = kernel.run("%ros2 interface show demo_interfaces/msg/Spot")
    assert "float64[] sizes" in kernel.text(shown)
    kernel.run("stop()")


def test_an_interface_package_built_again_after_its_import_needs_a_restart_and_says_so(kernel):
    assert kernel.text(kernel.run("ws.use(); ws.use()")) == ""
    # As another build leaves it: a new file in the place of the old one.
    again = (
        "for library in (ws.install / 'demo_interfaces/lib').glob('*.so'):\n"
        "    data = library.read_bytes(); library.unlink(); library.write_bytes(data)\n"
    )
    assert kernel.text(kernel.run(f"{again}ws.use()")) == ""
    kernel.run("import demo_interfaces.msg")
    said = kernel.text(kernel.run(f"{again}ws.use()"))
    assert said == "demo_interfaces was built again after it was imported. To use the new one, restart the kernel.\n"


def test_a_python_package_built_again_is_imported_afresh(kernel, small):
    kernel.run(f"ws = Workspace({str(small.folder)!r})")
    source = small.src / "demo_py/demo_py/listener.py"
    kernel.run("ws.build('--packages-select', 'demo_py'); ws.use()", 60)
    kernel.run("import demo_py.listener; assert not hasattr(demo_py.listener, 'ANSWER')")
    source.write_text(source.read_text() + "\n\nANSWER = 42\n")
    kernel.run("ws.build('--packages-select', 'demo_py'); ws.use()", 60)
    assert kernel.text(kernel.run("import demo_py.listener; print(demo_py.listener.ANSWER)")) == "42\n"


def test_an_interrupted_build_ends_with_all_its_compilers(kernel, small):
    pid_file = small.folder.parent / "pid"
    slow = f"import os, time; open({str(pid_file)!r}, 'w').write(str(os.getpid())); time.sleep(100)\n"
    (small.src / "demo_py/setup.py").write_text(slow + packages.SETUP_PY)
    cell = kernel.send(f"ws = Workspace({str(small.folder)!r}); ws.build('--packages-select', 'demo_py')")
    wait_until(lambda: pid_file.exists() and pid_file.read_text(), "start of the build", timeout=30)
    kernel.manager.interrupt_kernel()
    kernel.finish(cell)
    assert [m["content"]["ename"] for m in kernel.of(cell) if m["msg_type"] == "error"] == ["KeyboardInterrupt"]
    assert none_left([int(pid_file.read_text())])


def test_a_killed_kernel_leaves_no_built_node_behind(kernel):
    pid = int(kernel.text(kernel.run("print(os.getpid())")))
    kernel.run("launch = ws.start('ros2 launch demo_py demo.launch.py')")
    said = kernel.run("wait_for(lambda: launch.says('I heard'), timeout=30); print('\\n'.join(launch.lines))", 40)
    started = [line for line in kernel.text(said).splitlines() if "process started with pid" in line]
    pids = [int(line.split("[")[-1].rstrip("]")) for line in started]
    assert len(pids) == 2
    os.kill(pid, signal.SIGKILL)
    wait_until(lambda: none_left(pids), f"end of {pids}", timeout=30)


def test_a_failed_build_shows_a_kernel_no_traceback(kernel, small):
    (small.src / "demo_py/setup.py").write_text(packages.SETUP_PY.replace("name=package_name,", "name=nonsense,"))
    cell = kernel.send(f"Workspace({str(small.folder)!r}).build('--packages-select', 'demo_py')")
    kernel.finish(cell, 60)
    (error,) = (m["content"] for m in kernel.of(cell) if m["msg_type"] == "error")
    shown = "\n".join(error["traceback"])
    assert "NameError: name 'nonsense' is not defined" in shown
    assert "workspaces.py" not in shown and len(shown.splitlines()) < 10


@pytest.mark.parametrize(
    ("file", "old", "new", "says"),
    [
        ("demo_py/setup.py", "    version=", "    version==", ["SyntaxError", "to do: setup.py itself is wrong"]),
        (
            "demo_py/setup.py",
            "find_packages(exclude=['test'])",
            "['demo']",
            ["error: package directory 'demo' does not exist", "to do: setup.py lists the package demo"],
        ),
        (
            "demo_py/setup.py",
            "'talker = ",
            "'talker ",
            ["to do: an argument of setup() in setup.py has a wrong form; entry points are 'name = package.module"],
        ),
        ("demo_cpp/src/hello.cpp", "return 0;", "retrun 0;", ["hello.cpp:6:3: error: ", "6 |   retrun 0;"]),
        ("demo_cpp/src/hello.cpp", "main", "mein", ["undefined reference to `main'"]),
        (
            "demo_cpp/CMakeLists.txt",
            "find_package(ament_cmake REQUIRED)",
            "find_package(ament_cmake REQUIRED)\nfind_package(nowhere REQUIRED)",
            ["CMake Error at CMakeLists.txt:5 (find_package):", "to do: find_package(nowhere) finds no nowhere"],
        ),
    ],
    ids=["syntax", "package", "entry point", "compiler", "linker", "find_package"],
)
def test_a_failed_build_says_which_package_and_why_in_a_few_lines(small, capsys, file, old, new, says):
    package = file.partition("/")[0]
    text = (small.src / file).read_text()
    assert old in text
    (small.src / file).write_text(text.replace(old, new))
    with pytest.raises(BuildError) as raised:
        small.build("--packages-select", package)
    lines = str(raised.value).splitlines()
    assert lines[0].startswith(f"✘ {package} was not built (exited with code ")
    assert [text for text in says if text not in str(raised.value)] == []
    assert len(lines) <= 11
    printed = capsys.readouterr().out
    assert f"Starting >>> {package}" in printed and "Traceback" not in printed and "rror: " not in printed
    assert raised.value.build.failed.keys() == {package}


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (
            "string Name\n",
            "Error processing 'string Name' of 'demo_interfaces/Spot': ''Name' is an invalid field",
        ),
        ("strin name\n", "'strin' is an invalid message name."),
        ("nowhere_msgs/Foo foo\n", "to do: an interface uses a type of nowhere_msgs: name it in CMakeLists.txt"),
    ],
)
def test_a_wrong_interface_file_is_explained(small, text, says):
    packages.add_interface_package(small.src)
    (small.src / "demo_interfaces/msg/Spot.msg").write_text(text)
    with pytest.raises(BuildError) as raised:
        small.build("--packages-select", "demo_interfaces")
    assert says in str(raised.value)
    assert len(str(raised.value).splitlines()) <= 8


def test_a_failed_build_can_be_looked_at(small, capsys):
    (small.src / "demo_cpp/CMakeLists.txt").write_text("projekt(demo_cpp)")
    build = small.build("--packages-select", "demo_cpp", check=False)
    assert not build.ok
    assert list(build.failed) == ["demo_cpp"]
    assert 'Unknown CMake command "projekt"' in capsys.readouterr().out


@pytest.mark.skipif(" " in sys.prefix, reason="setuptools' development scripts do not start from a path with a space")
def test_with_symlink_install_a_changed_file_needs_no_new_build(small):
    small.build("--packages-select", "demo_py", "--symlink-install")
    source = small.src / "demo_py/demo_py/talker.py"
    source.write_text(
        source.read_text().replace("def main(args=None):", "def main(args=None):\n    return print('new')")
    )
    talker = small.start("ros2 run demo_py talker")
    assert wait_for(talker, timeout=STARTED) == 0
    assert talker.lines == ["new"]


def test_nothing_to_build_is_said(small, capsys):
    assert small.build("--packages-select", "demo_pi").finished == {}
    printed = capsys.readouterr().out
    assert "ignoring unknown package 'demo_pi'" in printed
    assert f"Nothing was built. Packages in {small.src}: demo_cpp, demo_py." in printed


def test_a_wrong_argument_is_named(small, capsys):
    with pytest.raises(BuildError, match="unrecognized arguments: --package-select"):
        small.build("--package-select", "demo_py")


def test_before_the_first_build_there_is_nothing_to_source(small):
    with pytest.raises(FileNotFoundError, match=r"setup.bash does not exist: it comes with the first successful"):
        small.use()


def test_reset_gives_a_fresh_workspace_and_keeps_the_last_sources(small):
    (small.folder / "install").mkdir()
    small.reset()
    assert [path.name for path in small.folder.iterdir()] == ["src"]
    assert list(small.src.iterdir()) == []
    kept = small.folder.with_name("ros2_ws_before")
    assert sorted(path.name for path in kept.iterdir()) == ["demo_cpp", "demo_py"]
    small.reset()  # of an empty one keeps what was kept
    assert sorted(path.name for path in kept.iterdir()) == ["demo_cpp", "demo_py"]


def test_reset_of_a_package_leaves_the_others(small):
    for name in ("build/demo_py", "install/demo_py", "install/demo_cpp"):
        (small.folder / name).mkdir(parents=True)
    small.reset("demo_py", "not_there")
    assert small.packages == ["demo_cpp"]
    assert [path.name for path in small.install.iterdir()] == ["demo_cpp"]
    kept = small.folder.with_name("ros2_ws_before")
    assert [path.name for path in kept.iterdir()] == ["demo_py"]
    for name in ("", "..", "a/b", "/tmp"):
        with pytest.raises(ValueError, match="nothing is removed"):
            small.reset(name)


def test_reset_removes_nothing_from_a_folder_that_is_no_workspace(small):
    (small.folder / "thesis.txt").write_text("two years of work")
    with pytest.raises(ValueError, match=r"thesis\.txt.* nothing is removed"):
        small.reset()
    assert sorted(path.name for path in small.src.iterdir()) == ["demo_cpp", "demo_py"]


def test_git_ignores_a_workspace_beside_the_notebooks():
    root = Path(__file__).resolve().parents[1]
    if not (root / ".git").exists():
        pytest.skip("this copy of the course is no git repository")
    for folder in ("notebooks/ros2_ws/", "notebooks/ros2_ws_before/"):
        assert subprocess.run(["git", "check-ignore", "-q", folder], cwd=root, timeout=20).returncode == 0


@pytest.mark.skipif(not has_package(os.environ["COURSE_KIT_PREFIX"], "rclpy"), reason="apt's ROS 2 brings make")
def test_without_make_ninja_builds(small, tmp_path):
    tools = tmp_path / "tools"
    tools.mkdir()
    for name in ("bash", "sh", "cc", "c++", "gcc", "g++", "ld", "as", "ar", "ranlib", "env", "uname", "dirname"):
        if found := shutil.which(name, path=os.defpath):  # not those of ccache
            (tools / name).symlink_to(found)
    prefix_bin = Path(os.environ["COURSE_KIT_PREFIX"], "bin")
    environ = fresh_environ(PATH=f"{prefix_bin}:{tools}")
    command = [prefix_bin / "colcon", "build", "--packages-select", "demo_cpp"]
    done = subprocess.run(command, cwd=small.folder, env=environ, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (small.folder / "build/demo_cpp/build.ninja").exists()


def test_the_lines_of_a_build_are_understood():
    output = Build()
    lines = ["Starting >>> slow", "Starting >>> bad", "Finished <<< slow [1min 2.5s]"]
    lines += ["--- stderr: bad", "a", "", "---", "Failed   <<< bad [0.5s, exited with code 2]"]
    shown = [text for line in lines for text in output.feed(line)]
    assert output.finished == {"slow": 62.5} and output.failed == {"bad": "exited with code 2"}
    assert "a" not in shown
    assert output.explanation().splitlines()[:2] == ["✘ bad was not built (exited with code 2)", "    a"]
    assert output.lines == lines


def test_warnings_of_a_package_that_was_built_are_shown_shortly():
    output = Build()
    shown = []
    for line in ("Starting >>> good", "--- stderr: good", *(f"w{n}" for n in range(30)), "---"):
        shown += output.feed(line)
    assert shown == ["Starting >>> good"]
    shown = output.feed("Finished <<< good [2.0s]")
    assert shown[:2] == ["good was built, and said:", "  w0"]
    assert shown[-2:] == ["  ... 20 lines more", "Finished <<< good [2.0s]"]
