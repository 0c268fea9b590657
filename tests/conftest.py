"""Each test process gets a ROS domain of its own, on localhost, with the course's discovery profile."""

from __future__ import annotations

import faulthandler
import gc
import json
import os
import signal
from collections.abc import Iterator
from typing import Any

import pytest

from tests import leftovers
from tests.domains import give_back, own_domain, use_own_domain
from tests.scheduling import GroupScheduling

IS_WORKER = "PYTEST_XDIST_WORKER" in os.environ
GROUPS = "COURSE_KIT_TEST_GROUPS"  # those that are run, if not all
# Seconds that groups of tests take on 2 cores, beside each other; others take SHORT ones.
SECONDS = {
    "exercises of workspace-5": 495,
    "grading a class": 490,
    "cheats 0": 400,
    "cheats 1": 400,
    "cheats 2": 400,
    "bare bookworm": 484,
    "bare noble": 484,
    "bare trixie": 470,
    "exercises of actions-5": 426,
    "exercises of robot-9": 420,
    "exercises of topics-4": 353,
    "exercises of topics": 298,
    "exercises of debugging-7": 282,
    "06_debugging": 246,
    "exercises of topics-1": 235,
    "exercises of workspace-4": 233,
    "test_faults_robot": 226,
    "exercises of setup": 218,
    "exercises of robot-8": 270,
    "02_workspace": 198,
    "exercises of actions": 194,
    "exercises of debugging-3": 182,
    "exercises of services-5": 166,
    "exercises of workspace": 156,
    "exercises of debugging": 155,
    "exercises of workspace-2": 154,
    "test_environment_setup": 150,
    "exercises of debugging-2": 148,
    "test_workspaces": 143,
    "05_actions": 133,
    "exercises of robot-4": 130,
    "exercises of actions-4": 129,
    "exercises of robot": 110,
    "03_topics": 109,
    "04_services": 106,
    "07_robot": 130,
    "exercises of services-2": 103,
    "exercises of debugging-6": 101,
    "exercises of actions-2": 97,
    "test_cheat_sheet": 110,
    "test_checker": 90,
    "test_turtle_in_browser": 110,
    "test_robot_in_browser": 120,
    "test_browser_start": 80,
    "exercises of services": 80,
    "test_definitions": 79,
    "test_environment_apt": 65,
    "test_leftovers": 90,
    "test_first_errors": 80,
    "test_turtlesim_node": 57,
    "test_ros2_bad_input": 58,
    "test_ros2_echo_pub": 55,
    "test_ros2_rates": 80,
    "test_ros2_bag": 46,
    "test_progress_bar": 70,
    "test_form_in_browser": 60,
    "test_consoles_in_browser": 45,
    "test_navigation_nodes": 45,
    "test_progress_in_browser": 45,
    "test_views_leave_nothing": 25,
    "test_browser": 43,
    "01_setup_checks": 39,
    "test_ros2_interrupt": 36,
    "test_ros2_launch_end": 36,
    "test_recording": 34,
    "test_robot_view": 28,
    "test_ros2_calls": 34,
    "test_robot_node": 30,
    "test_bad_input": 25,
    "test_full_disk": 23,
    "test_ros2_generated_input": 34,
    "test_tf_tools": 35,
    "test_graph_plots": 33,
    "test_ros2_transcripts": 31,
    "test_ros2_graph": 31,
    "test_ros2_service_echo": 30,
    "test_environment_failures": 31,
    "test_discovery": 29,
    "test_kernel": 29,
    "test_replay": 28,
    "test_bags": 28,
    "test_processes": 27,
    "test_chapter_packages": 25,
    "test_watchdog": 25,
    "test_ros2_children": 24,
    "test_internals_rclpy": 23,
    "test_overlay": 23,
    "test_ros2_launch": 18,
    "test_tf_ros": 16,
}
SHORT = 8
TIMEOUT = 120  # seconds of a test without a mark of its own
STDERR = os.dup(2)  # which pytest replaces while it captures
CHANGED_LIMIT = 110  # of the two minutes that --changed may take, without the start

if not IS_WORKER:
    leftovers.begin()
    leftovers.compile_once()
use_own_domain()
os.environ["OPENBLAS_NUM_THREADS"] = "1"  # a process with rclpy imports numpy, whose threads cost 0.1 s to start
# A shell that starts the tests in the background has them, and all that they start, ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)
if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:  # so does `nohup` with SIGHUP: it is heeded there, and not here
    signal.signal(signal.SIGHUP, lambda *_: None)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--full", action="store_true", help="also what is marked slow, and each notebook twice")
    parser.addoption("--changed", action="store_true", help="what changes since upstream can break, in two minutes")


def pytest_configure(config: pytest.Config) -> None:
    """With --changed, choose what is run."""
    if config.getoption("changed") and not IS_WORKER:
        from tests.changed import nearest

        beside = config.getoption("numprocesses", None) or 1
        chosen, left = nearest(lambda group: SECONDS.get(group, SHORT), CHANGED_LIMIT, beside)
        if not chosen:
            pytest.exit("Nothing has changed that a test depends on.", returncode=0)
        os.environ[GROUPS] = json.dumps(chosen)
        print(f"Changes can break: {', '.join(chosen)}.")
        print(f"Further away, and left to a run of all: {', '.join(left) or 'none'}.")


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> GroupScheduling | None:
    """Where groups are run beside each other, have a group outlive the end of its process."""
    return GroupScheduling(config, log) if config.getoption("dist") == "loadgroup" else None


def group(item: pytest.Item) -> str:
    """Tests of a group run one after another, where tests run beside each other: its own, or that of its module."""
    mark = item.get_closest_marker("xdist_group")
    return str(mark.args[0]) if mark else item.path.stem


def is_run(item: pytest.Item) -> bool:
    """Whether a test belongs to what is asked for; the groups that a change can break are run whole."""
    if GROUPS in os.environ:
        return group(item) in json.loads(os.environ[GROUPS])
    return bool(item.config.getoption("full")) or item.get_closest_marker("slow") is None


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Say where a test stands when its time is over, and end its process, in which later tests would fail too.

    The C library does so, because a native call may hold Python's lock.
    """
    mark = item.get_closest_marker("timeout")
    faulthandler.dump_traceback_later(mark.args[0] if mark else TIMEOUT, file=STDERR, exit=True)
    try:
        return (yield)
    finally:
        faulthandler.cancel_dump_traceback_later()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """What takes longest begins, so that the workers end together."""
    config.hook.pytest_deselected(items=[item for item in items if not is_run(item)])
    items[:] = sorted(filter(is_run, items), key=lambda item: -SECONDS.get(group(item), SHORT))
    for item in items:
        if item.get_closest_marker("xdist_group") is None:
            item.add_marker(pytest.mark.xdist_group(group(item)))


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Nothing is left of the tests; a process that does not end makes them fail, and then their files are kept."""
    if IS_WORKER:
        return
    if left := leftovers.end_processes():
        session.exitstatus = pytest.ExitCode.TESTS_FAILED
        print("\nProcesses were left:", *left, sep="\n")
    leftovers.remove_shared_memory()
    if session.exitstatus == pytest.ExitCode.TESTS_FAILED:
        leftovers.keep_files()
        print(f"\nThe tests' files are kept in {leftovers.KEPT}")


@pytest.fixture(scope="module")
def fresh_domain() -> Iterator[None]:
    """A domain in which no earlier test of this process has left a node, for tests that look at the whole graph."""
    from course_kit.spinning import context

    context.stop()
    with own_domain() as domain:
        yield
        context.stop()
    gc.collect()  # a participant stays in the domain until the handles of its nodes become garbage
    give_back(domain)
