"""Each test process gets a ROS domain of its own, on localhost, with the course's discovery profile."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Iterator

import pytest

from tests import leftovers
from tests.domains import own_domain, use_own_domain

IS_WORKER = "PYTEST_XDIST_WORKER" in os.environ
GROUPS = "COURSE_KIT_TEST_GROUPS"  # those that are run, if not all
# Seconds that groups of tests take on 2 cores, beside each other; others take SHORT ones.
SECONDS = {
    "bare noble": 235,
    "bare bookworm": 235,
    "bare trixie": 230,
    "06_debugging": 220,
    "exercises of workspace-5": 219,
    "exercises of actions": 201,
    "test_faults_robot": 188,
    "exercises of debugging": 180,
    "02_workspace": 146,
    "exercises of workspace": 118,
    "05_actions": 116,
    "03_topics": 104,
    "exercises of topics": 102,
    "test_environment_setup": 101,
    "test_workspaces": 96,
    "exercises of workspace-4": 91,
    "04_services": 87,
    "exercises of services": 76,
    "test_turtlesim_node": 65,
    "test_checker": 60,
    "test_ros2_echo_pub": 50,
    "test_ros2_bag": 39,
    "test_ros2_launch_end": 34,
    "exercises of setup": 32,
    "test_ros2_calls": 32,
    "test_environment_failures": 31,
    "test_graph_plots": 30,
    "01_setup_checks": 30,
    "test_kernel": 27,
    "test_discovery": 25,
    "test_internals_rclpy": 25,
    "test_ros2_transcripts": 24,
    "test_processes": 24,
    "test_ros2_graph": 23,
    "test_recording": 22,
    "test_exit_timer": 22,
    "test_bags": 22,
    "test_environment_apt": 21,
    "test_ros2_children": 18,
    "test_browser": 18,
}
SHORT = 8
CHANGED_LIMIT = 110  # of the two minutes that --changed may take, without the start

if not IS_WORKER:
    leftovers.begin()
    leftovers.compile_once()
use_own_domain()
os.environ["OPENBLAS_NUM_THREADS"] = "1"  # a process with rclpy imports numpy, whose threads cost 0.1 s to start
# A shell that starts the tests in the background has them, and all that they start, ignore Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)


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


def group(item: pytest.Item) -> str:
    """Tests of a group run one after another, where tests run beside each other: its own, or that of its module."""
    mark = item.get_closest_marker("xdist_group")
    return str(mark.args[0]) if mark else item.path.stem


def is_run(item: pytest.Item) -> bool:
    """Whether a test belongs to what is asked for; the groups that a change can break are run whole."""
    if GROUPS in os.environ:
        return group(item) in json.loads(os.environ[GROUPS])
    return bool(item.config.getoption("full")) or item.get_closest_marker("slow") is None


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
    with own_domain():
        yield
        context.stop()
