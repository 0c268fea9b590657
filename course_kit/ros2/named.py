"""What `list`, `type` and `find` print of topics, services and actions alike: names and their types."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from course_kit.ros2.session import Session
from course_kit.ros2.verbs import did_you_mean

NamesAndTypes = Mapping[str, Sequence[str]]


def names(named: NamesAndTypes, with_types: bool) -> list[str]:
    """A line for each name, with its types in brackets if wanted."""
    return [f"{name} [{', '.join(types)}]" if with_types else name for name, types in named.items()]


def print_list(session: Session, named: NamesAndTypes, count_only: bool, with_types: bool) -> None:
    """What `list` prints: the names, or how many there are."""
    lines = [str(len(named))] if count_only else names(named, with_types)
    if lines:
        session.print("\n".join(lines))


def print_types(session: Session, types: Sequence[str]) -> int:
    """What `type` prints; the exit status is 1 if there is none."""
    for name in types:
        session.print(name)
    return 0 if types else 1


def print_found(
    session: Session, named: NamesAndTypes, wanted: str, count_only: bool, installed: Collection[str]
) -> None:
    """What `find` prints: the names of a type, or how many there are; a suggestion for a type that is not installed."""
    found = {name: types for name, types in named.items() if wanted in types}
    print_list(session, found, count_only, with_types=False)
    if not found and wanted not in installed and (suggestion := did_you_mean(wanted, installed)):
        session.warn(suggestion)
