"""Verbs for everything that has a name and types, topics, services and actions: list, type and find."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from course_kit.cli.ros2.completion import names_of, type_of, types_in_use
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import GRAPH, Arguments, CommandError, Verb, all_of, argument, did_you_mean, flag

NamesAndTypes = Mapping[str, Sequence[str]]


@dataclass(frozen=True)
class Named:
    """Topics, services or actions."""

    noun: str
    example: str  # of a name
    example_type: str
    can_hide: bool = True

    @property
    def name(self) -> Arguments:
        """The argument of verbs about one name."""
        return argument(f"{self.noun}_name", f"the {self.noun}, such as {self.example}", names_of(self.noun))

    def typed(self, name: str, **settings: object) -> Arguments:
        """The type of what is named."""
        return argument(name, f"its type, such as {self.example_type}", type_of(self.noun), **settings)

    @property
    def hidden(self) -> Arguments:
        """The option that also shows hidden names."""
        option = flag(f"--include-hidden-{self.noun}s", "include hidden ones, with an underscore in the name")
        return option if self.can_hide else all_of()

    @property
    def shown(self) -> Arguments:
        """The options of verbs that list."""
        return all_of(flag(f"-c --count-{self.noun}s", "print only the number"), self.hidden)

    def verbs(self) -> dict[str, Verb]:
        """The verbs that all have."""
        kind = argument(f"{self.noun}_type", f"the type, such as {self.example_type}", types_in_use(self.noun))
        with_types = flag("-t --show-types", "show their types")
        return {
            "find": Verb(f"list the {self.noun}s of a type", self._find, GRAPH, kind, self.shown),
            "list": Verb(f"list the {self.noun}s", self.list, GRAPH, with_types, self.shown),
            "type": Verb(f"say which type the {self.noun} has", self._type, GRAPH, self.name),
        }

    def list(self, args: Namespace, session: Session) -> None:
        """Print the names, with their types if wanted, or how many there are."""
        self._show(session.named(self.noun), args, session, args.show_types)

    def _show(self, named: NamesAndTypes, args: Namespace, session: Session, with_types: bool = False) -> None:
        lines = [str(len(named))] if getattr(args, f"count_{self.noun}s") else names(named, with_types)
        if lines:
            session.print("\n".join(lines))

    def _type(self, args: Namespace, session: Session) -> int:
        """Print the types of a name; the exit status is 1 if there is none."""
        types = session.named(self.noun).get(getattr(args, f"{self.noun}_name"), ())
        for name in types:
            session.print(name)
        return 0 if types else 1

    def _find(self, args: Namespace, session: Session) -> None:
        """Print the names of a type, or how many there are."""
        wanted = getattr(args, f"{self.noun}_type")
        self._show({name: types for name, types in session.named(self.noun).items() if wanted in types}, args, session)

    def type_line(self, name: str, named: NamesAndTypes) -> str:
        """What `info` begins with. CommandError if the name is not there."""
        if name not in named:
            raise CommandError(f"Unknown {self.noun} '{name}'", did_you_mean(name, named))
        types = named[name]
        return f"Type: {types[0] if len(types) == 1 else types}"


def names(named: NamesAndTypes, with_types: bool) -> list[str]:
    """A line for each name, with its types in brackets if wanted."""
    return [f"{name} [{', '.join(types)}]" if with_types else name for name, types in named.items()]


TOPICS = Named("topic", "/chatter", "std_msgs/msg/String")
SERVICES = Named("service", "/add_two_ints", "std_srvs/srv/SetBool")
ACTIONS = Named("action", "/fibonacci", "example_interfaces/action/Fibonacci", can_hide=False)
