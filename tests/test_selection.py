"""Which tests a run has: the tiers, the turns, the groups near a change, and what is left."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests import durations, landings
from tests.durations import Durations, Measured
from tests.landings import PARTS, THIRDS, part_of, third_of, turn
from tests.selection import Candidate, Tier, choose
from tests.test_fresh_machine import RELEASES

TESTS = [
    *(Candidate(f"quick[{number}]", "quick", "test_quick") for number in range(3)),
    *(
        Candidate(f"solved[{number}]", "solved", "test_answers", is_slow=number > 0, by_turns="group", kind="answer")
        for number in range(3)
    ),
    *(Candidate(f"fresh[{number}]", "fresh", "test_fresh", is_slow=True) for number in range(2)),
]
TURN = part_of("solved")
OTHER = next(part for part in range(PARTS) if part not in map(part_of, ("solved", "fresh")))
SECONDS = Durations(
    {
        "quick": {"fixtures": 1.0, "others": 2.0},
        "solved": {"fixtures": 10.0, "others": 5.0},
        "fresh": {"fixtures": 30.0, "others": 20.0},
    }
)


def run(tier: Tier) -> tuple[dict[str, int], Sequence[str], Sequence[str]]:
    """How many tests of each group are run, and what is left to other turns and beyond the limit."""
    choice = choose(TESTS, tier, SECONDS)
    return {group: len(part) for group, part in choice.chosen.items()}, choice.other_turns, choice.beyond_limit


@pytest.mark.parametrize(
    ("tier", "groups", "other_turns"),
    [
        (Tier("", TURN), {"solved": 1, "quick": 3}, []),
        (Tier("", OTHER), {"quick": 3}, ["solved"]),
        (Tier(""), {"solved": 1, "quick": 3}, []),  # of a folder that somebody names
        (Tier("full", TURN), {"solved": 3, "quick": 3}, ["fresh"]),
        (Tier("full", part_of("fresh")), {"fresh": 2, "quick": 3}, ["solved"]),
    ],
)
def test_a_tier_has_its_tests_the_longest_group_first(tier: Tier, groups: dict[str, int], other_turns) -> None:
    assert part_of("fresh") != TURN
    assert run(tier) == (groups, other_turns, [])
    assert list(run(tier)[0]) == list(groups)


def test_groups_that_need_a_processor_are_spread_over_the_run() -> None:
    tests = [
        Candidate(f"{kind} {number}", f"{kind} {number}", kind, is_cpu_bound=kind == "bound")
        for kind, count in (("bound", 2), ("light", 4))
        for number in range(count)
    ]
    seconds = Durations({test.group: {test.name: 40.0 - number} for number, test in enumerate(tests)})
    order = [*choose(tests, Tier("all"), seconds).chosen]
    assert order == ["bound 0", "light 0", "light 1", "bound 1", "light 2", "light 3"]


def test_a_run_says_how_many_slow_tests_it_leaves() -> None:
    assert choose(TESTS, Tier("", TURN), SECONDS).slow == 4
    assert choose(TESTS, Tier("full", TURN), SECONDS).slow == 0


@pytest.mark.parametrize(
    ("distances", "limit", "groups", "beyond"),
    [
        ({"fresh": 0}, 200.0, {"quick": 3, "fresh": 2}, []),
        ({"test_fresh": 0}, 200.0, {"quick": 3, "fresh": 2}, []),  # a group without imports of its own has its module's
        ({"fresh": None}, 200.0, {"quick": 3}, []),
        ({"solved": 1, "fresh": 0}, 200.0, {"quick": 3, "fresh": 2, "solved": 3}, []),
        ({"solved": 1, "fresh": 0}, 80.0, {"quick": 3, "fresh": 2}, ["solved"]),  # the nearest is taken first
        ({"solved": 0, "fresh": 0}, 80.0, {"quick": 3, "solved": 3}, ["fresh"]),  # of those as near the shorter one
    ],
)
def test_groups_near_the_change_are_whole_as_long_as_they_fit(distances, limit, groups, beyond) -> None:
    tier = Tier("full", OTHER, distances, limit, limit)
    assert run(tier)[0] == groups
    assert run(tier)[2] == beyond


def test_changed_has_the_nearest_group_however_long_it_takes() -> None:
    assert run(Tier("changed", None, {"fresh": 2, "solved": 3}, 20.0, 10.0)) == ({"fresh": 2}, [], ["solved"])
    assert run(Tier("changed", None, {"fresh": 2, "solved": 3}, 200.0, 10.0))[2] == ["solved"]  # too long a group


def test_five_landings_have_all_parts_and_the_commits_draw_their_order() -> None:
    commits = [hashlib.sha1(str(number).encode()).hexdigest() for number in range(50)]
    turns = [turn(commits[:number], commit) for number, commit in enumerate(commits)]
    rounds = [turns[start : start + PARTS] for start in range(0, len(turns), PARTS)]
    assert all(sorted(one) == list(range(PARTS)) for one in rounds)
    assert len(set(map(tuple, rounds))) > 5


def test_of_a_function_whose_cases_take_turns_there_is_always_one_and_five_turns_have_all() -> None:
    many = [Candidate(f"many[{number}]", "cases", "test_cases", by_turns="cases") for number in range(40)]
    few = [Candidate(f"few[{number}]", "cases", "test_cases", by_turns="cases") for number in range(2)]
    for tier in ("", "full"):
        turns = [choose([*many, *few], Tier(tier, turn), SECONDS).chosen["cases"] for turn in range(PARTS)]
        assert {test for part in turns for test in part} == {*many, *few}
        assert all(1 <= len({*few} & {*part}) <= 2 for part in turns)
        assert max(len({*many} & {*part}) for part in turns) < 20
    assert len(choose([*many, *few], Tier(""), SECONDS).chosen["cases"]) == 42


def test_the_long_tests_of_a_module_take_turns_and_it_always_has_a_test() -> None:
    long = [Candidate(f"long {number}", "module", "module", by_turns="tests") for number in range(40)]
    short = Candidate("short", "module", "module")
    thirds = [(part, third) for part in range(PARTS) for third in range(THIRDS)]
    runs = [choose([*long, short], Tier("", part, third=third), SECONDS).chosen["module"] for part, third in thirds]
    assert all(short in run and len(run) < 12 for run in runs)
    assert {test for run in runs for test in run} == {*long, short}
    turns = [choose([*long, short], Tier("full", part), SECONDS).chosen["module"] for part in range(PARTS)]
    assert all(short in run and 1 < len(run) < 20 for run in turns)
    assert {test for run in turns for test in run} == {*long, short}
    assert all(choose(long[:1], Tier("", part, third=0), SECONDS).chosen for part in range(PARTS))


def test_a_test_is_long_from_a_second_on() -> None:
    known = Durations({"group": {"long": 1.0, "short": 0.9, "others": 2.0}})
    assert [known.is_long("group", test) for test in ("long", "short", "unknown")] == [True, False, False]


def test_a_run_has_a_third_of_its_turn_and_of_each_kind_one() -> None:
    kinds = {"many": 60, "few": 5}
    tests = [
        Candidate(f"{kind} {number}", f"{kind} {number}", kind, by_turns="group", kind=kind)
        for kind, count in kinds.items()
        for number in range(count)
    ]
    for part in range(PARTS):
        whole = choose(tests, Tier("full", part), SECONDS).chosen
        thirds = [choose(tests, Tier("", part, third=third), SECONDS).chosen for third in range(THIRDS)]
        assert {group for group in whole if part_of(group) == part} == {
            group for third in thirds for group in third if part_of(group) == part
        }
        assert all(any("few" in group for group in third) for third in thirds)
        for number, third in enumerate(thirds):
            many = {group for group in third if "many" in group}
            of_third = {group for group in whole if (part_of(group), third_of(group)) == (part, number)}
            assert many == {group for group in of_third if "many" in group} or (len(many) == 1 and not of_third & many)


def test_the_parts_are_about_as_long_as_each_other() -> None:
    """If one of these two fails after many changes, another SALT is due, with its DEALT."""
    seconds = Counter[int]()
    for group in (known := Durations.read()).seconds:
        seconds[part_of(group)] += int(known.of_whole(group))
    assert max(seconds.values()) < 1.5 * sum(seconds.values()) / PARTS


def test_no_part_has_two_bare_systems() -> None:
    bare = [part_of(f"bare {system}") for system in RELEASES]
    assert len(set(bare)) == len(bare)


def test_the_landings_are_commits_of_this_repository() -> None:
    found = landings.landed()
    assert all(len(commit) == 40 and int(commit, 16) for commit in found)
    if landings.commit() == landings.NO_COMMIT:
        pytest.skip("this copy of the course is no git repository")
    assert landings.git("merge-base", "HEAD", found[-1]) == [found[-1]]


def test_a_run_keeps_what_it_measured_over_what_was_known(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(durations, "KEPT", tmp_path / "kept.json")
    monkeypatch.setattr(durations, "MEASURED", tmp_path / "build/measured.json")
    known = {"fixtures": 3.0, "long": 9.0, "not run": 5.0, "short": 4.0}
    durations.write({"a": known, "b": {"others": 1.0}}, durations.KEPT)
    measured = Measured()
    for test, seconds in [("fixtures", 1.0), ("fixtures", 1.0), ("long", 7.0), ("short", 0.2), ("shorter", 0.1)]:
        measured.add("a", test, seconds)
    measured.add("c", "long", 80.0)
    assert [group for group, _ in measured.groups()] == ["c", "a"]
    measured.keep()
    assert json.loads(durations.MEASURED.read_text())["a"] == {
        "fixtures": 2.0,
        "long": 7.0,
        "not run": 5.0,
        "others": 0.15,
    }
    assert json.loads(durations.MEASURED.read_text())["c"] == {"long": 80.0}
    read = Durations.read()
    assert read.of("c", ["new"]) == durations.UNKNOWN
    assert read.of("a", ["long", "short", "never run"]) == pytest.approx(2.0 + 7.0 + 2 * 0.15)
    assert read.of("b", ["any"]) == 1.0
    assert read.of("unknown", ["any", "other"]) == 2 * durations.UNKNOWN
