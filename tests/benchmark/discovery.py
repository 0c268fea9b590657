"""How fast a fresh node finds a running one, what that costs, and whether messages flow as fast as before.

Stock Fast DDS and the course's profile run side by side in domains of their own and take turns.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial

import psutil  # type: ignore[import-untyped]

from tests.benchmark.ceiling import CEILING, KEPT, highest_rate
from tests.benchmark.child import Program
from tests.benchmark.programs.fresh_listener import TIMEOUT
from tests.benchmark.table import Row, at_least, at_most, higher
from tests.domains import reserve_domain

DEPTH = 100
NOTE = (
    "discovery: a warm talker publishes at 100 Hz in a plain rclpy process, a fresh process makes a listener; seconds "
    "from its node created to its first callback. 2 nodes: 2 processes; 20 nodes: in 5 processes, and the fresh one. "
    f"Throughput: a process publishes serialised messages, another counts them (reliable, depth {DEPTH}): {CEILING}."
)
LIMIT = 0.5  # s
SYSTEMS = {2: [(0, 1)], 20: [(process, 4) for process in range(5)]}
PROFILES = ("stock", "course")
RATIO_NOISE = 0.9  # the ratio of two equal systems varies by so much from run to run
FIRST_RATE = {"String": 2000.0, "LaserScan": 2000.0, "Image": 30.0}  # held on any machine


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    domains = {profile: reserve_domain() for profile in PROFILES}
    for nodes in SYSTEMS:
        yield from first_message(nodes, 10 if quick else 100, domains)
    yield from idle_cpu(5.0 if quick else 30.0, domains)
    for kind in ("String", "LaserScan", "Image"):
        yield throughput(kind, 1 if quick else 3, 0.5 if quick else 1.0, domains)


def first_message(nodes: int, runs: int, domains: dict[str, int]) -> Iterator[Row]:
    """The time to the first message of a fresh listener beside running nodes."""
    reports: dict[str, list[dict[str, float]]] = {profile: [] for profile in PROFILES}
    with ExitStack() as stack:
        warm = [
            stack.enter_context(
                Program("warm_nodes", process, count, nodes if nodes > 2 else 1, domain=domain, profile=profile)
            )
            for profile, domain in domains.items()
            for process, count in SYSTEMS[nodes]
        ]
        for program in warm:
            program.report()
        time.sleep(3.0)  # stock participants announce themselves every 3 s: all is quiet after that
        for run in range(runs):
            print(f"\rdiscovery: {nodes} nodes, run {run + 1} of {runs} ", end="", file=sys.stderr)
            for profile, domain in domains.items():
                with Program("fresh_listener", domain=domain, profile=profile) as listener:
                    reports[profile].append(listener.report())
                time.sleep(0.05 + 0.011 * (run % 10))  # meets the periodic announcements at varying moments
        print(file=sys.stderr)
    first = {profile: sorted(r["first"] or TIMEOUT for r in reports[profile]) for profile in PROFILES}
    whole = {profile: sorted((r["first"] or TIMEOUT) + r["create"] for r in reports[profile]) for profile in PROFILES}
    what = f"first message, {nodes} nodes"
    stock, course = first["stock"], first["course"]
    yield Row(f"{what}: median", "s", statistics.median(stock), statistics.median(course))
    yield Row(f"{what}: p90", "s", stock[int(0.9 * runs)], course[int(0.9 * runs)])
    yield at_most(f"{what}: slowest", "s", course[-1], LIMIT, stock[-1])
    within = {profile: sum(seconds <= LIMIT for seconds in first[profile]) for profile in PROFILES}
    yield at_least(f"{what}: within {LIMIT:g} s", f"of {runs}", within["course"], runs, within["stock"])
    within = {profile: sum(seconds <= LIMIT for seconds in whole[profile]) for profile in PROFILES}
    yield Row(f"{what}: the same, making the node included", f"of {runs}", within["stock"], within["course"])


def idle_cpu(seconds: float, domains: dict[str, int]) -> Iterator[Row]:
    """What announcing and listening costs a process that does nothing, alone and among five."""
    for processes in (1, 5):
        with ExitStack() as stack:
            idle = {
                profile: [
                    stack.enter_context(Program("idle_node", domain=domain, profile=profile)) for _ in range(processes)
                ]
                for profile, domain in domains.items()
            }
            for profile in PROFILES:
                for program in idle[profile]:
                    program.report()
            time.sleep(3.0)
            before = {profile: _cpu(idle[profile]) for profile in PROFILES}
            time.sleep(seconds)
            percent = {
                profile: 100 * (_cpu(idle[profile]) - before[profile]) / seconds / processes for profile in PROFILES
            }
        yield at_most(
            f"CPU of an idle node's process, {processes} in the domain",
            "% of a core",
            percent["course"],
            1.0,
            percent["stock"],
        )


def _cpu(programs: list[Program]) -> float:
    return sum(sum(psutil.Process(program.pid).cpu_times()[:2]) for program in programs)


def throughput(kind: str, repetitions: int, seconds: float, domains: dict[str, int]) -> Row:
    """Messages a second from one process to another without loss; the median of repetitions in turn."""
    found: dict[str, list[float]] = {profile: [] for profile in PROFILES}
    for repetition in range(repetitions):
        print(f"\rdiscovery: throughput of {kind}, {repetition + 1} of {repetitions} ", end="", file=sys.stderr)
        for profile in PROFILES if repetition % 2 else reversed(PROFILES):
            domain = domains[profile]
            # New ones each time: after more than they hold, large messages come late for many seconds.
            with Program("stream_receiver", kind, DEPTH, domain=domain, profile=profile) as receiver:
                receiver.report()
                with Program("stream_sender", kind, DEPTH, domain=domain, profile=profile) as sender:
                    sender.report()
                    held = partial(_held, sender, receiver, seconds)
                    found[profile].append(highest_rate(held, first=FIRST_RATE[kind]))
    print(file=sys.stderr)
    stock, course = (statistics.median(found[profile]) for profile in PROFILES)
    return higher(f"throughput of {kind}, two processes", "messages/s", stock, course, RATIO_NOISE)


def _held(sender: Program, receiver: Program, seconds: float, rate: float) -> float | None:
    sender.tell(f"send {rate} {seconds}")
    sent = sender.report(seconds + 60)
    receiver.tell("count")
    complete = receiver.report()["count"] == sent["sent"] and sent["rate"] >= KEPT * rate
    return float(sent["rate"]) if complete else None
