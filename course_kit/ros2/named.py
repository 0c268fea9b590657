"""The verbs `list`, `type` and `find`, which topics, services and actions have alike."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from course_kit.ros2.completion import installed_types, names_of, types_in_use
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import add_flag, add_offered, add_strategy_arguments, did_you_mean

NamesAndTypes = Mapping[str, Sequence[str]]


@dataclass(frozen=True)
class Named:
    """What the graph knows by names and types: topics, services or actions."""

    noun: str
    example: str  # of a name
    example_type: str = ""
    can_hide: bool = True

    def add_name(self, parser: ArgumentParser, purpose: str) -> None:
        """The argument of verbs about one name."""
        text = f"Name of the ROS {self.noun} to {purpose} (e.g. '{self.example}')"
        add_offered(parser, f"{self.noun}_name", names_of(self.noun), text)

    def add_hidden(self, parser: ArgumentParser) -> None:
        """The option that also shows hidden names."""
        if self.can_hide:
            add_flag(parser, f"--include-hidden-{self.noun}s", f"Consider hidden {self.noun}s as well")

    def _add_count(self, parser: ArgumentParser) -> None:
        text = f"Only display the number of {self.noun}s discovered"
        add_flag(parser, f"-c --count-{self.noun}s", text)

    def found(self, args: Namespace, session: Session) -> NamesAndTypes:
        """Names and types, hidden ones only if they were asked for."""
        return session.named(self.noun, getattr(args, f"include_hidden_{self.noun}s", False))

    def list_arguments(self, parser: ArgumentParser) -> None:
        """The arguments of `list`."""
        add_strategy_arguments(parser)
        add_flag(parser, "-t --show-types", f"Additionally show the {self.noun} type")
        self._add_count(parser)
        self.add_hidden(parser)

    def list(self, args: Namespace, session: Session) -> None:
        """Print the names, with their types if wanted, or how many there are."""
        self.show(self.found(args, session), args, session, args.show_types)

    def show(self, named: NamesAndTypes, args: Namespace, session: Session, with_types: bool = False) -> None:
        """Print names, with their types if wanted, or how many there are."""
        lines = [str(len(named))] if getattr(args, f"count_{self.noun}s") else names(named, with_types)
        if lines:
            session.print("\n".join(lines))

    def type_arguments(self, parser: ArgumentParser) -> None:
        """The arguments of `type`."""
        add_strategy_arguments(parser)
        self.add_name(parser, "get type")

    def type(self, args: Namespace, session: Session) -> int:
        """Print the types of a name; the exit status is 1 if there is none."""
        types = session.named(self.noun).get(getattr(args, f"{self.noun}_name"), ())
        for name in types:
            session.print(name)
        return 0 if types else 1

    def find_arguments(self, parser: ArgumentParser) -> None:
        """The arguments of `find`."""
        add_strategy_arguments(parser)
        text = f"Name of the ROS {self.noun} type to filter for (e.g. '{self.example_type}')"
        add_offered(parser, f"{self.noun}_type", types_in_use(self.noun), text)
        self._add_count(parser)
        self.add_hidden(parser)

    def find(self, args: Namespace, session: Session) -> None:
        """Print the names of a type, or how many there are; a suggestion for a type that is not installed."""
        wanted = getattr(args, f"{self.noun}_type")
        found = {name: types for name, types in self.found(args, session).items() if wanted in types}
        self.show(found, args, session)
        installed = () if found else installed_types(self.noun)
        if wanted not in installed and (suggestion := did_you_mean(wanted, installed)):
            session.warn(suggestion)


def names(named: NamesAndTypes, with_types: bool) -> list[str]:
    """A line for each name, with its types in brackets if wanted."""
    return [f"{name} [{', '.join(types)}]" if with_types else name for name, types in named.items()]
