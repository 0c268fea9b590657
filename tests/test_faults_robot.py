"""Every fault on the real robot: seen with the tools, felt in its health, its cause stated, and repaired.

The robot runs on from fault to fault; what a fault does not concern is not started anew.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import groupby
from typing import Any

import psutil  # type: ignore[import-untyped]
import pytest

from course_kit import start
from course_kit.base import polling
from course_kit.cli.ros2 import command
from course_kit.exercises import faults
from course_kit.exercises.catalogue import find
from course_kit.exercises.checker.examination import Ended, Examination, begin, current
from course_kit.exercises.debugging.robot_well import expect_well
from course_kit.exercises.faults import all_faults, health, lab
from course_kit.exercises.faults.fault import PROGRAMS
from course_kit.ros.observing.domain_observer import DomainObserver
from course_kit.ros.spinning import context
from tests.exercises.no_notebook import NoNotebook
from tests.kernel import Kernel
from tests.ros2_command import ros2
from tests.ros2_launches import none_left
from tests.waiting import wait_until

pytestmark = [
    pytest.mark.usefixtures("fresh_domain"),
    pytest.mark.by_turns("a fault each", of="cases"),
]

LOOK_TIMEOUT = 30.0  # a look may take 6 s where discovery is slow
HEALTHY_TIMEOUT = 25.0
# A name, QoS, discovery, an executor, a program that ends, two nodes of a name, one that is only thought to be there.
OF_EACH_KIND = {"name", "qos", "domain", "deadlock", "crash", "duplicate", "dead"}


@pytest.fixture(scope="module")
def observer() -> Iterator[DomainObserver]:
    context.start()
    observer = DomainObserver(None, only_here=False)
    yield observer
    observer.close()


@pytest.fixture(scope="module", autouse=True)
def robot() -> Iterator[None]:
    yield
    faults.stop()
    left = [one.pid for one in psutil.Process().children(recursive=True) if "patrol/" in " ".join(one.cmdline())]
    assert not left


def says(line: str) -> str:
    """What a command line prints in this process, as `%ros2 …` does in a notebook."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        command.run(shlex.split(line)[1:])
    return printed.getvalue()


def shows(line: str, *texts: str) -> None:
    """A command line prints these texts; a moment later at most."""
    said = ""

    def is_shown() -> bool:
        nonlocal said
        said = says(line)
        return all(text in said for text in texts)

    assert polling.wait_until(is_shown, LOOK_TIMEOUT), f"not all of {texts} in what {line} prints:\n{said}"


def lacks(line: str, text: str) -> None:
    """A command line prints no line that is this text; a moment later at most."""
    wait_until(lambda: text not in says(line).splitlines(), f"{line} without {text}", LOOK_TIMEOUT)


def rate(topic: str, seconds: float = 2.0) -> float:
    """The last average rate that `ros2 topic hz` prints; 0 if none."""
    found = re.findall(r"average rate: ([\d.]+)", says(f"ros2 topic hz {topic} --duration {seconds:g}"))
    return float(found[-1]) if found else 0.0


def see_name() -> None:
    shows("ros2 node info /planner", "/laser: sensor_msgs/msg/LaserScan")
    shows("ros2 topic info /laser", "Publisher count: 0", "Subscription count: 1")


def see_type() -> None:
    shows("ros2 topic type /turtle1/cmd_vel", "geometry_msgs/msg/Twist\n", "geometry_msgs/msg/TwistStamped\n")


def see_qos() -> None:
    shows("ros2 topic info -v /scan", "Reliability: RELIABLE", "Reliability: BEST_EFFORT")
    shows("ros2 param get /planner qos_overrides./scan.subscription.reliability", "String value is: reliable")


def see_first_message() -> None:
    shows("ros2 topic info -v /speed_limit", "Durability: VOLATILE", "Durability: TRANSIENT_LOCAL")
    latched = "--qos-durability transient_local --qos-reliability reliable"
    shows(f"ros2 topic echo /speed_limit --once {latched}", "data: 1.0")


def see_domain() -> None:
    lacks("ros2 node list", "/scanner")
    assert faults.process("scanner").is_running
    assert str(faults.terminal("scanner", "printenv ROS_DOMAIN_ID")) != os.environ["ROS_DOMAIN_ID"]


def see_discovery() -> None:
    lacks("ros2 node list", "/map_server")
    assert faults.process("map_server").is_running
    assert str(faults.terminal("map_server", "printenv ROS_DOMAIN_ID")) == os.environ["ROS_DOMAIN_ID"]
    assert str(faults.terminal("map_server", "printenv ROS_AUTOMATIC_DISCOVERY_RANGE")) == "OFF"


def see_namespace() -> None:
    shows("ros2 node list", "/robot1/map_server\n")
    shows("ros2 service info /get_map", "Services count: 0", "Clients count: 1")


def see_remapping() -> None:
    shows("ros2 topic info /turtle1/cmd_vel", "Publisher count: 0")
    shows("ros2 node info /planner", " /cmd_vel: geometry_msgs/msg/Twist")


def see_service_name() -> None:
    shows("ros2 service info /get_map", "Services count: 0")
    shows("ros2 service find nav_msgs/srv/GetMap", "/static_map")


def see_slow_callback() -> None:
    shows("ros2 param get /planner planning_time", "Double value is: 1.0")
    wait_until(lambda: 0.3 < rate("/turtle1/cmd_vel", 4.0) < 3.0, timeout=LOOK_TIMEOUT)


def see_deadlock() -> None:
    shows("ros2 node list", "/planner\n")
    assert rate("/turtle1/cmd_vel", 3.0) == 0.0


def see_no_spin() -> None:
    shows("ros2 service info /get_map", "Services count: 1", "Clients count: 1")
    shows("ros2 topic echo /turtle1/cmd_vel --once", "x: 0.0")
    assert faults.process("planner").says("standing: no map")


def scans_an_update() -> float:
    """By how much /map_scans grows in each update of the map, which come twice a second; 0 if too few came."""
    counts = [int(one) for one in re.findall(r"data: (\d+)", says("ros2 topic echo /map_scans --duration 3"))]
    return (counts[-1] - counts[0]) / (len(counts) - 1) if len(counts) > 1 else 0.0


def see_queue() -> None:
    shows("ros2 param get /map_server qos_overrides./scan.subscription.depth", "Integer value is: 1")
    wait_until(lambda: 0.0 < scans_an_update() < 4.0, "an update with less than 4 of its 5 scans", LOOK_TIMEOUT)


def see_timer() -> None:
    wait_until(lambda: rate("/turtle1/cmd_vel", 3.0) > 50.0, timeout=LOOK_TIMEOUT)
    shows("ros2 topic info /turtle1/cmd_vel", "Publisher count: 1")


def see_logging() -> None:
    wait_until(lambda: rate("/rosout", 3.0) > 50.0, timeout=LOOK_TIMEOUT)


def see_clock() -> None:
    shows("ros2 param get /planner use_sim_time", "Boolean value is: True")
    shows("ros2 topic info /clock", "Publisher count: 0")


def see_crash() -> None:
    wait_until(lambda: not faults.process("planner").is_running)
    assert faults.process("planner").says("ValueError: min()")
    lacks("ros2 node list", "/planner")


def see_no_server() -> None:
    shows("ros2 service info /get_map", "Services count: 0", "Clients count: 1")
    lacks("ros2 node list", "/map_server")
    with pytest.raises(ValueError, match="was not started"):
        faults.process("map_server")


def see_duplicate() -> None:
    wait_until(lambda: says("ros2 node list").splitlines().count("/planner") == 2)
    shows("ros2 topic info /turtle1/cmd_vel", "Publisher count: 2")


def see_not_sourced() -> None:
    assert faults.process("planner").says("Package 'patrol' not found")
    assert "faults/robot" not in str(faults.terminal("planner", "printenv AMENT_PREFIX_PATH"))
    lacks("ros2 node list", "/planner")


def see_conda() -> None:
    assert faults.process("scanner").says("No module named 'rclpy'")
    assert "miniconda3/bin/python3" in str(faults.terminal("scanner", "which python3"))
    lacks("ros2 node list", "/scanner")


def see_dead() -> None:
    assert "/scanner" in says("ros2 node list").splitlines()
    assert "/scanner" not in ros2("node", "list").out.splitlines()  # of a newcomer, who has never known it
    assert "Publisher count: 1" in says("ros2 topic info /scan")
    assert rate("/scan", 3.0) == 0.0
    assert faults.process("scanner").state == "failed (SIGKILL)"


SEE: dict[str, Callable[[], None]] = {name[4:]: see for name, see in globals().items() if name.startswith("see_")}


def type_cell(cell: str) -> None:
    """Do what the lines of a cell say: `%ros2 …` as a command line, all else as Python."""
    names = {"start": start}
    for is_magic, lines in groupby(cell.splitlines(), key=lambda line: line.startswith("%ros2 ")):
        if not is_magic:
            exec("\n".join(lines), names)
            continue
        for line in lines:
            assert command.run(shlex.split(line)[1:]) == 0


def is_well() -> bool:
    """Return True if the robot is well, or becomes so, as a student asks."""
    told = faults.is_repaired(HEALTHY_TIMEOUT)
    running = [faults.process(one) for one in PROGRAMS]
    assert told, "\n".join([str(told), *(f"{one}: {one.lines[-5:]}" for one in running)])
    return True


def test_every_fault_is_looked_at():
    assert list(SEE) == list(all_faults.FAULTS)


def test_a_robot_without_a_fault_is_well():
    assert "nothing is wrong" in str(faults.start())
    assert is_well()


def test_a_second_planner_beside_one_that_hangs_is_no_repair():
    faults.start("deadlock")
    start("ros2 run patrol planner --ros-args -r cmd_vel:=turtle1/cmd_vel")  # without its name
    told = faults.is_repaired(timeout=6.0)
    assert not told
    assert "More than one is called /planner" in str(told)


def test_a_student_asks_whether_it_is_repaired_before_and_after():
    told = faults.start(seed=1)
    fault = lab._lab.fault
    assert fault is not None
    assert fault.id not in str(told).split("One of these")[0]
    before = faults.is_repaired(timeout=3.0)
    assert not before
    assert "✘" in str(before)
    type_cell(fault.repair)
    after = faults.is_repaired()
    assert after
    assert str(after).startswith("Repaired.")
    assert "What was the cause?" in str(after)


def test_a_check_can_ask_the_same(observer: DomainObserver):
    exercise = replace(find("topics-1"), node_class=None, node="/planner", timeout=60.0)
    faults.start()
    begin(Examination(exercise, observer, observer, {}, NoNotebook()))
    try:
        assert expect_well(points=1, timeout=HEALTHY_TIMEOUT)
        faults.process("map_server").stop()
        with pytest.raises(Ended):
            expect_well(points=1, timeout=2.5)
        assert [one.points for one in current().findings] == [1, 0]
        assert "nearly every scan gets into the map" in current().findings[-1].hint
    finally:
        begin(None)
        observer.tidy()


def every_fault() -> Iterator[Any]:
    """Their ids; further ones of a kind are slow. A part of them runs one after another."""
    for number, name in enumerate(all_faults.FAULTS):
        slow = [] if name in OF_EACH_KIND else [pytest.mark.slow("the others of its kind are like it")]
        yield pytest.param(name, marks=[*slow, pytest.mark.xdist_group(f"faults of the robot {number % 3}")])


@pytest.mark.parametrize("name", list(every_fault()))
def test_fault(name: str, observer: DomainObserver):
    fault = all_faults.find(name)
    assert fault.symptom in str(faults.start(name))
    assert faults.process("planner").says(fault.says)
    listening = health.Watch(observer)
    SEE[name]()
    wait_until(lambda: listening.seconds >= health.WINDOW)
    assert not all(one.ok for one in health.findings(listening.observe()))
    observer.tidy()
    for one in all_faults.options(fault):
        assert bool(faults.answer(one.id)) == (one.id == name)
    type_cell(fault.repair)
    assert is_well()


def test_nothing_is_left_when_the_kernel_is_shut_down():
    kernel = Kernel()
    try:
        kernel.run("from course_kit import faults\nfaults.start('duplicate')", timeout=60)
        pid = int(kernel.text(kernel.run("import os; print(os.getpid())")))
        programs = [one.pid for one in psutil.Process(pid).children(recursive=True) if "patrol/" in str(one.cmdline())]
        assert len(programs) == 5
        kernel.client.shutdown()
        wait_until(lambda: none_left(programs), timeout=20)
    finally:
        kernel.close()
