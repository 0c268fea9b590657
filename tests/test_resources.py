"""CPU and memory by node process: which process a node lives in, and what it uses."""

from __future__ import annotations

import os
import re
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NoReturn

import numpy as np
import psutil  # type: ignore[import-untyped]
import pytest
from rclpy.node import Node
from std_msgs.msg import String

from course_kit.base.programs import processes
from course_kit.base.programs.child_process import Process
from course_kit.lab.background import running
from course_kit.lab.recordings.rates import measure_rates
from course_kit.lab.resources import processes_with_nodes, resource_recording
from course_kit.lab.resources.processes_with_nodes import NOTEBOOK, listens
from course_kit.lab.resources.resource_plots import plot_resources
from course_kit.lab.resources.resource_recording import record_resources
from course_kit.ros.private_api.fastdds_parts import Origin
from course_kit.ros.spinning import context
from course_kit.ros.subscriptions import observer_node
from tests.waiting import wait_until

PROGRAM = [sys.executable, str(Path(__file__).with_name("plain_node.py"))]


class Burner(Node):
    """Computes for 30 of each 100 ms."""

    def __init__(self) -> None:
        super().__init__("burner")
        self.out = self.create_publisher(String, "/burnt", 10)
        self.create_timer(0.1, self.tick)

    def tick(self) -> None:
        start = time.thread_time()
        while time.thread_time() - start < 0.03:
            pass
        self.out.publish(String(data="x"))


def of(node: str) -> processes_with_nodes.NodeProcess | None:
    return next((one for one in processes_with_nodes.node_processes() if node in one.nodes), None)


@pytest.fixture(scope="module")
def busy() -> Iterator[Process]:
    """A node that computes, in a process of its own, beside two nodes of this process."""
    running.run(Burner)
    running.run(Node, "idle")
    process = processes.start([*PROGRAM, "worker", "busy"], name="worker")
    wait_until(lambda: of("/robot/worker"))
    yield process
    process.stop()
    running.stop()
    context.stop()


def test_the_id_of_an_endpoint_tells_host_and_process() -> None:
    gid = bytes.fromhex("010f78fd607c93a9000000000000030300000000")
    assert Origin.of(gid) == Origin(bytes.fromhex("78fd"), 0x7C60)
    assert Origin.of(bytes(16)) is None  # another middleware's


def test_each_node_is_found_in_its_process(busy: Process) -> None:
    worker, own = of("/robot/worker"), of("/burner")
    assert worker is not None and worker.pid == busy.pid and worker.program == "plain_node.py"
    assert own is not None and own.pid == os.getpid() and own.program == NOTEBOOK
    assert {"/burner", "/idle"} <= set(own.nodes)
    assert processes_with_nodes.node_processes()[0] == own


def test_a_process_that_takes_no_part_is_not_believed(busy: Process) -> None:
    domain = observer_node.node().context.get_domain_id()
    assert listens(os.getpid(), domain) and listens(busy.pid, domain)
    assert not listens(os.getppid(), domain) and not listens(busy.pid, (domain + 50) % 100)


@pytest.mark.parametrize(
    ("origin", "answer"),
    [
        (Origin(b"\0\0", 1), (None, "on another machine")),
        (Origin(b"", 0), (None, "process has ended")),
        (Origin(b"", 1), (None, "process not known")),  # process 1 is there, but not in the domain
    ],
)
def test_what_is_not_known_is_said(busy: Process, origin: Origin, answer: tuple[None, str]) -> None:
    own = processes_with_nodes._own_origin(observer_node.node())
    assert own is not None and own.pid_bits == os.getpid() & 0xFFFF
    taken = {pid & 0xFFFF for pid in psutil.pids()}
    bits = next(bits for bits in range(30_000, 0, -1) if bits not in taken) if origin.pid_bits == 0 else origin.pid_bits
    origin = Origin(origin.host or own.host, bits)
    assert processes_with_nodes._process_of(origin, own, observer_node.node().context.get_domain_id()) == answer


@pytest.mark.parametrize(
    ("words", "program"),
    [
        (["/usr/bin/python3", "/opt/ros/jazzy/lib/demo/talker", "--ros-args"], "talker"),
        (["python", "-m", "course_kit.robots.turtlesim", "turtlesim_node"], "turtlesim_node"),
        (["python", "-m", "course_kit.robots.turtlesim", "--ros-args"], "turtlesim"),
        (["python3.11", "-u", "-m", "my_package.main", "x"], "my_package.main"),
        (["/opt/ros/jazzy/lib/demo_nodes_cpp/talker", "-r", "x"], "talker"),
        (["python", "-c", "pass"], "python"),
        ([""], ""),
    ],
)
def test_a_program_is_named_as_a_student_started_it(words: list[str], program: str) -> None:
    assert processes_with_nodes._program(words) == program


def test_cpu_and_memory_are_those_of_the_process(busy: Process) -> None:
    measured = psutil.Process(busy.pid)
    before, start = sum(measured.cpu_times()[:2]), time.monotonic()
    recorded = record_resources(seconds=2.0, period=0.1)
    share = 100 * (sum(measured.cpu_times()[:2]) - before) / (time.monotonic() - start)
    worker, thread = recorded.of("/robot/worker"), recorded.of("burner")
    assert worker.pid == busy.pid and not worker.is_thread
    assert worker.cpu.mean() == pytest.approx(share, rel=0.25)
    assert worker.cpu.mean() > 2  # it asks for 50; what it gets depends on what else runs
    assert worker.memory[-1] == pytest.approx(measured.memory_info().rss / 1e6, rel=0.05)
    assert len(worker) >= 5 and np.all(np.diff(worker.when_ns) > 0)
    # The thread of a node in this process has its own share, the idle one none.
    assert thread.is_thread and 1 < thread.cpu.mean() < 60 and np.isnan(thread.memory).all()
    assert recorded.of("idle").cpu.mean() < 5
    shown = repr(recorded)
    assert f"plain_node.py ({busy.pid})" in shown and "thread of /burner" in shown and "this notebook" in shown
    with pytest.raises(KeyError, match="no process of a node /nobody was measured; there are /burner"):
        recorded.of("nobody")


def test_a_process_that_comes_later_joins_and_one_that_ends_stays(busy: Process) -> None:
    with record_resources(period=0.1) as recorded:
        late = processes.start([*PROGRAM, "late"], name="late")
        wait_until(lambda: any(one.pid == late.pid and len(one) > 3 for one in recorded.values()))
        late.stop()
        wait_until(lambda: of("/robot/late") is None)
        assert recorded.is_running
    assert not recorded.is_running
    assert len(recorded.of("/robot/late")) > 3


def test_a_recording_that_nobody_holds_ends(busy: Process) -> None:
    thread = record_resources(period=0.05)._sampler.thread
    wait_until(lambda: not thread.is_alive())


def test_a_recording_that_fails_says_so_and_how_to_go_on(busy: Process, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> NoReturn:
        raise RuntimeError("no graph")

    monkeypatch.setattr(resource_recording, "node_processes", fail)
    recorded = record_resources(period=0.05)
    wait_until(lambda: not recorded.is_running)
    assert repr(recorded).splitlines()[-1] == (
        "This recording stands still: RuntimeError: no graph. Run its cell again to go on."
    )


def test_usage_is_drawn_beside_the_rates(busy: Process) -> None:
    with measure_rates("/burnt") as meter, record_resources(period=0.1) as recorded:
        wait_until(lambda: len(recorded.of("/robot/worker")) > 8 if len(recorded) > 2 else False)
    figure = plot_resources(recorded, meter)
    assert [axes.get_ylabel() for axes in figure.axes] == ["CPU [% of a core]", "memory [MB]", "rate [Hz]"]
    labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]  # type: ignore[union-attr]
    assert f"/robot/worker ({busy.pid})" in labels and "thread of /burner" in labels
    assert len(plot_resources(recorded).axes) == 2
    told = repr(figure)
    assert re.search(rf" /robot/worker \({busy.pid}\): CPU .* % of a core, .* in the mean, memory .* MB\. ", told)
    assert told.startswith("Resources. ") and re.search(r" /burnt: .* Hz\.$", told)
    assert figure._repr_png_()[0].startswith(b"\x89PNG")


def test_what_makes_no_sense_is_refused() -> None:
    with pytest.raises(ValueError, match=r"period=0\.001 is too short"):
        record_resources(period=0.001)
    with pytest.raises(ValueError, match="seconds must be a span of time"):
        record_resources(seconds=0)
    with pytest.raises(TypeError, match=r"plot_resources\(\) draws what record_resources\(\) returns, not str"):
        plot_resources("x")  # type: ignore[arg-type]
