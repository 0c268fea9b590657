"""Lifecycle nodes in a launch: brought up by events, and told of when they change their state."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.ros2_launches import PROGRAMS, Prefix, RunningGroup

BRING_UP = """
    node := LifecycleNode(package="demo", executable="managed", name="arm", namespace="robot1", output="screen",
                          parameters=[{"fails": FAILS}]),
    RegisterEventHandler(OnStateTransition(target_lifecycle_node=node, start_state="configuring", goal_state="inactive",
        entities=[LogInfo(msg="configured"),
                  EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(node), transition_id=3))])),
    RegisterEventHandler(OnStateTransition(target_lifecycle_node=node, goal_state="unconfigured",
        entities=[LogInfo(msg="not configured")])),
    RegisterEventHandler(OnStateTransition(goal_state="active", entities=[
        LogInfo(msg=["active: ", LocalSubstitution("event.start_state")]), Shutdown(reason="done")])),
    EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(node), transition_id=1)),
    EmitEvent(event=ChangeState(lifecycle_node_matcher=lambda action: False, transition_id=2)),
"""


@pytest.fixture
def prefix(tmp_path: Path) -> Prefix:
    prefix = Prefix(tmp_path / "install")
    prefix.program("demo", "managed", (PROGRAMS / "launched_lifecycle_node.py").read_text())
    return prefix


def launch(prefix: Prefix, entities: str) -> RunningGroup:
    path = prefix.launch_file("demo", "demo.launch.py", entities)
    imports = (
        "from launch.events import matches_action",
        "from launch_ros.event_handlers import OnStateTransition",
        "from launch_ros.events.lifecycle import ChangeState",
    )
    path.write_text("\n".join([*imports, path.read_text()]))
    return RunningGroup("launch", "demo", "demo.launch.py", environment=prefix.environment)


def test_events_bring_a_lifecycle_node_up(prefix: Prefix) -> None:
    with launch(prefix, BRING_UP.replace("FAILS", "False")) as running:
        assert running.end().status == 0, running.text
        said = [line.partition("]: ")[2] for line in running.lines if "launch.user" in line]
        assert said == ["configured", "active: activating"]
        assert [line for line in running.lines if line.startswith("[managed-1] ")] == [
            "[managed-1] configuring",
            "[managed-1] active",
        ]


def test_a_transition_that_fails_is_told(prefix: Prefix) -> None:
    with launch(prefix, BRING_UP.replace("FAILS", "True")) as running:
        running.wait_for("not configured")
        running.wait_for("Failed to make transition 'TRANSITION_CONFIGURE' for LifecycleNode '/robot1/arm'")
        running.interrupt()
        assert running.end().status == 0


@pytest.mark.parametrize("end", ["the node", "the launch"])
def test_nothing_waits_for_a_node_that_has_no_states(prefix: Prefix, end: str) -> None:
    code = "print('up'); import time; time.sleep(100)" if end == "the launch" else "pass"
    prefix.program("demo", "managed", code)
    with launch(prefix, BRING_UP.replace("FAILS", "False")) as running:
        if end == "the launch":
            running.wait_for("Still waiting for the '/robot1/arm/change_state' service: is '/robot1/arm' a lifecycle")
            running.interrupt()
        assert running.end().status == 0
        assert "Abandoning wait for the '/robot1/arm/change_state' service, " in running.text


def test_what_is_no_transition_and_no_lifecycle_node_is_refused(prefix: Prefix) -> None:
    for entity, reason in (
        (
            "EmitEvent(event=ChangeState(lifecycle_node_matcher=None, transition_id='up'))",
            "transition_id is 'up', no id",
        ),
        (
            "RegisterEventHandler(OnStateTransition(target_lifecycle_node=1, entities=[]))",
            "target_lifecycle_node is 1, no LifecycleNode",
        ),
    ):
        with launch(prefix, entity) as running:
            assert running.end().status == 1
            assert reason in running.text
