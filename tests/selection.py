"""Which tests a run has: every kind of proof on few cases, or more of them, or all.

| tier      | ordinary | of a second or more      | by_turns                 | slow             | near the change      |
|-----------|----------|--------------------------|--------------------------|------------------|----------------------|
| (none)    | yes      | a third of the turn      | a third of the turn      | no               | no                   |
| --full    | yes      | whose turn it is         | whose turn it is         | whose turn it is | whole, up to a limit |
| --all     | yes      | yes                      | yes                      | yes              | yes                  |
| --changed | no       | no                       | no                       | no               | whole, up to a limit |

A run has one of each kind of which there are many: a case of each function whose cases take turns, a group of those
that do, and of each module a test.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import accumulate

from tests.durations import Durations, function_of
from tests.landings import PARTS, part_of, third_of

TIERS = {
    "full": "every kind: all cases where the change since the last landing is, of the rest those whose turn it is",
    "all": "everything",
    "changed": "what the changes since upstream can break, for two minutes",
}


@dataclass(frozen=True)
class Candidate:
    """A test as the choice sees it."""

    name: str
    group: str
    module: str
    is_slow: bool = False
    # "group", "cases" or "tests": a run has the groups, of each function the cases, or of each module the tests, whose
    # turn it is.
    by_turns: str = ""
    kind: str = ""  # of the groups that take turns: why they do
    is_cpu_bound: bool = False  # whether its group needs a processor as long as it runs

    @property
    def taking_turns(self) -> str:
        """Its name if it takes turns by itself, else that of its group."""
        return self.name if self.by_turns in ("cases", "tests") else self.group

    @property
    def part(self) -> int:
        """The part of the tests that it belongs to."""
        return part_of(self.taking_turns)

    @property
    def third(self) -> int:
        """The third of its part that it belongs to."""
        return third_of(self.taking_turns)


@dataclass(frozen=True)
class Tier:
    """How much a run has: of which part it is the turn, what is near the change, how many seconds that may take."""

    name: str  # "", "full", "all" or "changed"
    turn: int | None = None  # None: it is every part's
    distances: Mapping[str, int | None] = field(default_factory=dict)  # of groups or modules; None: cannot break
    limit: float = 0.0  # seconds of all tests, one after another
    longest: float = 0.0  # seconds of a group, unless it is among the nearest
    third: int | None = None  # of the part whose turn it is; None: the whole part

    def distance(self, group: Sequence[Candidate]) -> int | None:
        """How many imports lie between a group of tests and the change; None if it cannot break the group."""
        name, _, _ = group[0].group.partition(", part ")
        return self.distances.get(name, self.distances.get(group[0].module))


@dataclass
class Choice:
    """The groups of a run in their order, and what is left to another one."""

    chosen: dict[str, list[Candidate]] = field(default_factory=dict)
    other_turns: list[str] = field(default_factory=list)  # groups of which tests are left to another turn
    beyond_limit: list[str] = field(default_factory=list)  # groups near the change that did not fit
    slow: int = 0  # tests that are left to --full
    seconds: float = 0.0  # that its tests take, one after another


def choose(tests: Sequence[Candidate], tier: Tier, durations: Durations) -> Choice:
    """Choose the tests of a run: those of its tier, then groups near the change as long as they fit."""
    groups: dict[str, list[Candidate]] = defaultdict(list)
    for test in tests:
        groups[test.group].append(test)

    def seconds(group: str, part: Sequence[Candidate]) -> float:
        return durations.of(group, [test.name for test in part]) if part else 0.0

    of_tier = {test for test in tests if _is_of(tier, test)}
    if tier.turn is not None and tier.name != "changed":
        of_tier |= set(_one_of_each_kind(tests, of_tier, durations))
    chosen = {group: [test for test in part if test in of_tier] for group, part in groups.items()}
    more = {group: seconds(group, part) - seconds(group, chosen[group]) for group, part in groups.items()}
    spent = sum(seconds(group, part) for group, part in chosen.items())
    distances = {group: found for group, part in groups.items() if (found := tier.distance(part)) is not None}
    choice = Choice()
    for group in sorted(distances, key=lambda group: (distances[group], more[group])):
        is_short = more[group] <= tier.longest or distances[group] == min(distances.values())
        if is_short and (spent + more[group] <= tier.limit or not spent):
            chosen[group] = groups[group]
            spent += more[group]
        elif more[group]:
            choice.beyond_limit.append(group)

    lengths = {group: seconds(group, part) for group, part in chosen.items() if part}
    bound = {group for group in lengths if is_cpu_bound(chosen[group])}
    choice.chosen = {group: chosen[group] for group in _order(lengths, bound)}
    left = {test for part in groups.values() for test in part} - {test for part in chosen.values() for test in part}
    choice.seconds = spent
    if tier.name == "changed":
        return choice
    choice.slow = sum(test.is_slow for test in left) if tier.name == "" else 0
    choice.other_turns = sorted({test.group for test in left if tier.name == "full" or not test.is_slow})
    return choice


def is_cpu_bound(group: Sequence[Candidate]) -> bool:
    """True for a group of tests that needs a processor as long as it runs."""
    return any(test.is_cpu_bound for test in group)


def _order(seconds: Mapping[str, float], bound: Collection[str]) -> list[str]:
    """Groups by name, the longest first, so that the workers end together.

    Those that are bound to a processor, of which only a few run at once, are spread over the time of all.
    """
    places: dict[str, float] = {}
    for row in ([group for group in seconds if (group in bound) is is_bound] for is_bound in (True, False)):
        row.sort(key=lambda group: -seconds[group])
        begins = [*accumulate((seconds[group] for group in row), initial=0.0)]
        places |= {group: begin / (begins[-1] or 1.0) for group, begin in zip(row, begins, strict=False)}
    return sorted(places, key=lambda group: places[group])


def _is_of(tier: Tier, test: Candidate) -> bool:
    """True for a test that a tier has wherever the change is."""
    is_its_turn = tier.turn in (None, test.part)
    match tier.name:
        case "all":
            return True
        case "full":
            return is_its_turn or not (test.is_slow or test.by_turns)
        case "changed":
            return False
        case _:
            is_its_third = tier.third in (None, test.third)
            return not test.is_slow and ((is_its_turn and is_its_third) or not test.by_turns)


def _one_of_each_kind(
    tests: Sequence[Candidate], of_tier: Collection[Candidate], durations: Durations
) -> Iterator[Candidate]:
    """The shortest of each kind of which a tier has none; none that is slow.

    The cases of a function are a kind, and so are the groups of a kind, if there are as many as parts. The tests that
    take long in a module are one if the module has no others.
    """
    kinds = defaultdict[tuple[str, str], dict[str, list[Candidate]]](lambda: defaultdict(list))
    for test in tests:
        if test.by_turns and not test.is_slow:
            kind = {"cases": function_of(test.name), "tests": test.module}.get(test.by_turns, test.kind)
            kinds[test.by_turns, kind][test.taking_turns].append(test)
    begun = {test.module for test in of_tier}
    for (by_turns, kind), of_kind in kinds.items():
        is_there = any(part[0] in of_tier for part in of_kind.values())
        is_there |= by_turns == "tests" and kind in begun
        if not is_there and (by_turns != "group" or len(of_kind) >= PARTS):
            yield from min(of_kind.values(), key=lambda part: durations.of(part[0].group, [test.name for test in part]))
