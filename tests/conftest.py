"""Each test process gets a ROS domain of its own, on localhost, with the course's discovery profile."""

from __future__ import annotations

import faulthandler
import gc
import json
import os
import signal
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import pytest

from tests import leftovers
from tests.admission import Admission
from tests.domains import own_domain, use_own_domain
from tests.durations import Durations
from tests.landings import DEALT, PARTS, commit, landed, third, turn
from tests.report import Report
from tests.scheduling import GroupScheduling
from tests.selection import TIERS, Candidate, Choice, Tier, choose, is_cpu_bound
from tests.standing import standing

IS_WORKER = "PYTEST_XDIST_WORKER" in os.environ
TIER = "COURSE_KIT_TEST_TIER"  # for the workers, as JSON
ADMISSION = pytest.StashKey[Admission]()  # in a worker
MINUTES = {"full": 18.5, "changed": 1.8}  # that the tests of a tier may take, without the start
PER_PROCESSOR = 2  # tests that run at once, on the average of a run
TIMEOUT = 120  # seconds of a test without a mark of its own
STDERR = pytest.StashKey[int]()  # a copy of its descriptor, which pytest replaces while it captures

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
    tiers = parser.getgroup("tiers", "how much is run; see tests/selection.py")
    for name, text in TIERS.items():
        tiers.addoption(f"--{name}", dest="tier", action="store_const", const=name, default="", help=text)


def pytest_configure(config: pytest.Config) -> None:
    """Say to the workers how much is run, and measure and report it."""
    config.stash[STDERR] = os.dup(2)  # pytest captures while it imports this file, and not here
    if hasattr(config, "workerinput"):
        return
    tier = Tier(config.getoption("tier"))
    is_whole = config.getoption("dist") == "loadgroup"
    if is_whole:
        tier = of_whole_run(tier.name)
    is_measured = is_whole and not IS_WORKER  # not a run that a test of a run has started
    config.pluginmanager.register(Report(config, is_measured))
    os.environ[TIER] = json.dumps(asdict(tier))


def of_whole_run(name: str) -> Tier:
    """How much a run of all folders has."""
    distances: dict[str, int | None] = {}
    if name in MINUTES:
        from tests.changed import Dependencies, changed_files

        distances = Dependencies().distances(changed_files("@{upstream}" if name == "changed" else landed()[-1]))
        if name == "changed" and set(distances.values()) == {None}:
            pytest.exit("Nothing has changed that a test depends on.", returncode=0)
    limit = MINUTES.get(name, 0.0) * 60
    own_third = None if name else third(commit())
    at_once = PER_PROCESSOR * (os.cpu_count() or 1)
    return Tier(name, turn(landed()[DEALT:], commit()), distances, limit * at_once, limit, own_third)


def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> GroupScheduling | None:
    """Where groups are run beside each other, have a group outlive the end of its process."""
    return GroupScheduling(config, log) if config.getoption("dist") == "loadgroup" else None


def pytest_testnodedown(node: Any, error: object) -> None:
    """A worker has ended: if in the midst of a test, with programs that nobody ends."""
    if error:
        leftovers.kill_what_is_left_of(node.gateway.id)


def group(item: pytest.Item) -> str:
    """Tests of a group run one after another, where tests run beside each other: its own, or that of its module."""
    mark = item.get_closest_marker("xdist_group")
    return str(mark.args[0]) if mark else item.path.stem


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> Iterator[None]:
    """Have a group wait for its turn. Say where a test stands when its time is over, and end its process.

    Later tests would fail too in it. The C library does so, because a native call may hold Python's lock.
    """
    admission = item.config.stash.get(ADMISSION, None)
    if admission:
        admission.begin(group(item))
    mark = item.get_closest_marker("timeout")
    faulthandler.dump_traceback_later(mark.args[0] if mark else TIMEOUT, file=item.config.stash[STDERR], exit=True)
    try:
        return (yield)
    finally:
        faulthandler.cancel_dump_traceback_later()
        if admission and (nextitem is None or group(nextitem) != group(item)):
            admission.end()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    """Add to the report of a failure how this process stands in the graph."""
    report: Any = yield
    if report.failed and (text := standing()):
        report.sections.append(("This process in the graph", text))
    return report


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Choose the tests of the run, in their order."""
    durations = Durations.read()
    tests = {item: as_test(item, durations) for item in items}
    tier = Tier(**json.loads(os.environ[TIER]))
    choice = choose(list(tests.values()), tier, durations)
    chosen = {test for part in choice.chosen.values() for test in part}
    order = {group: number for number, group in enumerate(choice.chosen)}
    config.hook.pytest_deselected(items=[item for item in items if tests[item] not in chosen])
    items[:] = sorted((item for item in items if tests[item] in chosen), key=lambda item: order[group(item)])
    for item in items:
        if item.get_closest_marker("xdist_group") is None:
            item.add_marker(pytest.mark.xdist_group(group(item)))
    if hasattr(config, "workeroutput") and tier.turn is not None:  # a run of all folders
        config.workeroutput["left"] = told(choice, tier, len(tests))
        bound = {name for name, part in choice.chosen.items() if is_cpu_bound(part)}
        config.stash[ADMISSION] = Admission(config.workerinput["testrunuid"], bound)  # type: ignore[attr-defined]


def as_test(item: pytest.Item, durations: Durations) -> Candidate:
    """Return an item as the choice sees it: a test without a mark takes turns if it takes long."""
    by_turns = item.get_closest_marker("by_turns")
    slow, cpu_bound = (item.get_closest_marker(name) is not None for name in ("slow", "cpu_bound"))
    of, kind = (by_turns.kwargs.get("of", "group"), by_turns.args[0]) if by_turns else ("", "")
    if not (by_turns or slow) and durations.is_long(group(item), item.nodeid):
        of = "tests"
    return Candidate(item.nodeid, group(item), item.path.stem, slow, of, kind, cpu_bound)


def told(choice: Choice, tier: Tier, count: int) -> list[str]:
    """The lines that say what a run had and what it left."""
    run = sum(map(len, choice.chosen.values()))
    its_third = "" if tier.third is None else f", of which third {tier.third} of 0 to 2"
    lines = [f"Run: {run} of {count} tests; commit {commit()[:7]} has turn {tier.turn} of 0 to {PARTS - 1}{its_third}."]
    if choice.slow:
        lines.append(f"Left to --full and --all: {choice.slow} slow tests.")
    if choice.other_turns:
        lines.append(f"Left to other turns: {', '.join(choice.other_turns)}.")
    if choice.beyond_limit:
        lines.append(f"Near the change, but beyond the limit of time: {', '.join(choice.beyond_limit)}.")
    return lines


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
    from course_kit.ros.spinning import context

    context.stop()
    with own_domain():
        yield
        context.stop()
        gc.collect()  # a participant stays in the domain until the handles of its nodes become garbage
