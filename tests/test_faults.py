"""The fault lab's catalogue and its face: what is offered, what is said to a right and to a wrong answer."""

from __future__ import annotations

import re
import shlex
import zlib
from collections.abc import Iterator
from random import Random

import pytest
from sensor_msgs.msg import LaserScan

from course_kit.cli.ros2.command import parser_for
from course_kit.exercises import faults
from course_kit.exercises.debugging import robot_reactions
from course_kit.exercises.faults import all_faults, health, lab, robots_manual
from course_kit.exercises.faults.fault import HEALTHY, PROGRAMS, Fault
from course_kit.exercises.faults.terminals import TERMINALS, executable

pytestmark = pytest.mark.usefixtures("fresh_domain")

EVERY = list(all_faults.FAULTS.values())
GOOD = health.Observation(scans=10.0, commands=10.0, distance=1.5, scans_in_map=10.0, log_lines=2)


@pytest.fixture
def told_of(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The lab with a fault whose robot is not started."""
    monkeypatch.setattr(lab._lab, "fault", all_faults.find("qos"))
    monkeypatch.setattr(lab._lab, "hints_given", 0)
    yield


def test_there_are_at_least_fourteen_faults():
    assert len(EVERY) >= 14


@pytest.mark.parametrize("fault", EVERY, ids=lambda one: one.id)
def test_a_fault_can_be_chosen_from_several_causes_and_does_not_name_itself(fault: Fault):
    offered = [one.id for one in all_faults.options(fault)]
    assert len(set(offered)) == len(offered) == 5
    assert fault.id in offered
    assert fault.cause not in (fault.symptom, fault.evidence, *fault.hints)
    assert len(fault.hints) == 3
    assert fault.commands


@pytest.mark.parametrize("fault", EVERY, ids=lambda one: one.id)
def test_a_fault_starts_some_program_otherwise(fault: Fault):
    assert set(fault.programs) <= set(PROGRAMS)
    assert fault.extra or fault.programs
    assert all(start != HEALTHY[program] for program, start in fault.programs.items())
    starts = [start for start in (*fault.programs.values(), *fault.extra) if start is not None]
    assert all(start.terminal in TERMINALS for start in starts)


@pytest.mark.parametrize("fault", EVERY, ids=lambda one: one.id)
def test_command_lines_in_hints_are_ones_that_ros2_understands(fault: Fault):
    named = [line for hint in fault.hints for line in re.findall(r"`%ros2 ([^`]+)`", hint)]
    lines = [*named, *(line.partition(" ")[2] for line in fault.commands)]
    for line in lines:
        assert hasattr(parser_for(shlex.split(line)).parse_args(shlex.split(line)), "verb"), line


def test_every_program_can_be_run():
    assert [executable(program).name for program in PROGRAMS] == list(PROGRAMS)


def test_the_manual_says_how_each_program_is_started():
    text = robots_manual.text()
    assert all(f'start("{start.command}", name="{program}")' in text for program, start in HEALTHY.items())


# Of the chapter, its exercise and its answers, and of tests.
MEANT = {1: "deadlock", 7: "name", 9: "not_sourced", 17: "queue", 29: "remapping", 31: "clock"}


def test_a_seed_means_the_same_fault_for_good_also_when_faults_are_added(monkeypatch):
    monkeypatch.setitem(all_faults.FAULTS, "a_new_fault", EVERY[0])
    assert {seed: all_faults.pick(seed).id for seed in MEANT} == MEANT
    assert zlib.crc32(" ".join(all_faults.pick(seed).id for seed in range(100)).encode()) == 1166151681
    assert all_faults.pick(10_000_000).id in all_faults.FAULTS


def test_every_fault_has_a_seed():
    assert set(all_faults.SEEDS) == set(all_faults.FAULTS)


@pytest.mark.parametrize(
    ("change", "which"),
    [
        ({"scans": 0.0}, "/scan"),
        ({"scans_in_map": 5.0}, "map"),
        ({"commands": 20.0}, "cmd_vel"),
        ({"distance": 0.1}, "drives"),
        ({"log_lines": 700}, "log"),
        ({"twice": ("/planner",)}, "same name"),
    ],
)
def test_each_thing_that_is_not_well_is_found(change, which):
    assert all(one.ok for one in health.findings(GOOD))
    wrong = [one for one in health.findings(health.Observation(**{**vars(GOOD), **change})) if not one.ok]
    assert len(wrong) == 1
    assert which in wrong[0].text
    assert wrong[0].hint


def test_a_turtle_is_put_where_the_robot_must_drive_or_must_turn():
    for seed in range(200):
        is_free, wall = robot_reactions.open_place(Random(seed)), robot_reactions.place_at_a_wall(Random(seed))
        ahead = [angle / 10 for angle in range(-7, 8)]
        assert min(robot_reactions.distance_to_wall(is_free, angle) for angle in ahead) > 2.0
        assert 0.5 < min(robot_reactions.distance_to_wall(wall, angle) for angle in ahead) < 1.1


def test_a_scan_is_known_to_be_from_a_place():
    place, elsewhere = robot_reactions.Place(4.0, 7.0, 0.5), robot_reactions.Place(5.0, 7.0, 0.5)
    scan = LaserScan(angle_min=-3.0, angle_increment=0.5)
    scan.ranges = [robot_reactions.distance_to_wall(place, -3.0 + 0.5 * beam) for beam in range(13)]
    assert robot_reactions.is_from(scan, place)
    assert not robot_reactions.is_from(scan, elsewhere)
    assert not robot_reactions.is_from(LaserScan(), place)


def test_the_right_cause_is_accepted_and_others_are_refused_with_what_one_would_see(told_of):
    assert faults.answer("qos")
    for one in EVERY:
        if one.id != "qos":
            said = faults.answer(one.id)
            assert not said
            assert one.evidence in str(said)
            assert all_faults.find("qos").cause not in str(said)


def test_hints_come_one_after_another_and_the_last_one_again(told_of):
    said = [str(faults.hint()) for _ in range(4)]
    assert said[0].startswith("Hint 1 of 3: ")
    assert said[2] == said[3]
    assert len(set(said)) == 3


def test_a_solution_is_the_cause_and_a_cell(told_of):
    assert "start(" in str(faults.solution())


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        (lambda: faults.start("qoss"), "there is no fault 'qoss'. Did you mean 'qos'?"),
        (lambda: faults.start("qos", seed=1), "not both"),
        (lambda: faults.start(7), "there is no fault"),  # type: ignore[arg-type]
        (lambda: faults.start(seed="one"), "a seed is a whole number"),  # type: ignore[arg-type]
        (lambda: faults.answer("qos"), "No fault is in the robot"),
        (lambda: faults.hint(), "No fault is in the robot"),
        (lambda: faults.solution(), "No fault is in the robot"),
        (lambda: faults.symptom(), "No fault is in the robot"),
        (lambda: faults.is_repaired(), "No fault is in the robot"),
        (lambda: faults.terminal("scanner", "printenv"), "was not started from a terminal"),
    ],
)
def test_what_makes_no_sense_gets_one_line(asked, said):
    told = asked()
    assert not told
    assert said in str(told)
    assert len(str(told).splitlines()) == 1


def test_a_wrong_word_as_an_answer_gets_one_line(told_of):
    assert str(faults.answer("quos")) == "faults: there is no cause 'quos'. Did you mean 'qos'?"


def test_a_program_that_the_robot_does_not_have_is_refused():
    with pytest.raises(ValueError, match="simulator, scanner, map_server, planner"):
        faults.process("plannr")


def test_the_catalogue_lists_every_cause():
    shown = str(faults.catalogue())
    assert all(one.id in shown and one.cause in shown for one in EVERY)
    assert "<pre" in faults.catalogue()._repr_html_()
