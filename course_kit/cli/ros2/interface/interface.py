"""`ros2 interface`: list, show, package, packages, proto; from the definitions that are installed, without ROS."""

from __future__ import annotations

import os
import sys
from argparse import ArgumentError, Namespace
from collections.abc import Sequence
from typing import Any

from ament_index_python import get_resource, get_resources

from course_kit.cli.ros2.completion import offering
from course_kit.cli.ros2.interface import text
from course_kit.cli.ros2.interface.text import KINDS
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import (
    Arguments,
    CommandError,
    Verb,
    all_of,
    argument,
    did_you_mean,
    failing,
    flag,
    one_of,
)
from course_kit.ros import packages

INDEX = "rosidl_interfaces"
HEADINGS = {"msg": "Messages:", "srv": "Services:", "action": "Actions:"}


def installed() -> dict[str, list[str]]:
    """{package: ['msg/String', ...]} of every package that has interfaces, sorted; of two the first prefix counts."""
    return {package: _names(get_resource(INDEX, package)[0]) for package in sorted(get_resources(INDEX))}


def _names(listing: str) -> list[str]:
    """The interfaces of a package; each is listed with every suffix, and hidden ones have an underscore."""
    return sorted({line.rsplit(".", 1)[0] for line in listing.splitlines() if line and "_" not in line})


def types(kinds: Sequence[str] = KINDS) -> list[str]:
    """The full names of all types of some kinds, sorted."""
    found = (f"{package}/{name}" for package, names in installed().items() for name in names)
    return [name for name in found if name.split("/")[1] in kinds]


def path(type_name: str) -> str:
    """The file that defines a type. ValueError for what is no type name, LookupError as the real command's."""
    parts = type_name.split("/")
    for is_wrong, reason in (
        (len(parts) != 3, "Expected three parts separated by '/'"),
        (not all(parts), "Must not contain empty parts"),
        (".." in parts, "Must not contain '..'"),
    ):
        if is_wrong:
            raise ValueError(f"Invalid name '{type_name}'. {reason}")
    try:
        share = packages.share_directory(parts[0])
    except LookupError:
        raise LookupError(f"Unknown package '{parts[0]}'") from None
    stem = os.path.join(share, *parts[1:])
    candidates = [f"{stem}.{parts[1]}", f"{stem}.idl"]
    for candidate in candidates:
        if os.path.isfile(candidate):
            return candidate
    raise LookupError(f"Could not find the interface '{candidates[-1]}'")


def definition(type_name: str) -> str:
    """The text that defines a type; errors as of path()."""
    with open(path(type_name), encoding="utf-8") as file:
        return file.read()


def _path(name: str) -> str:
    """The file that defines a type. CommandError if there is none, with the type that may be meant."""
    try:
        return path(name)
    except (LookupError, ValueError) as error:
        package, word = name.split("/")[0], name.split("/")[-1]
        near = did_you_mean(name, [t for t in types() if t.startswith(f"{package}/") or t.endswith(f"/{word}")])
        if near is None and package not in installed():
            near = did_you_mean(package, installed())
        raise CommandError(str(error), near) from None


def _kinds(args: Namespace) -> list[str]:
    return [kind for kind in KINDS if getattr(args, f"only_{kind}s")] or list(KINDS)


def _list(args: Namespace, session: Session) -> None:
    for kind in _kinds(args):
        session.print("\n".join([HEADINGS[kind], *(f"    {name}" for name in types([kind]))]))


def _package(args: Namespace, session: Session) -> None:
    name = args.package_name
    try:
        packages.package_prefix(name)
    except LookupError:
        raise CommandError(f"Unknown package '{name}'", did_you_mean(name, installed())) from None
    kinds = _kinds(args)
    for interface in installed().get(name, []):
        if interface.split("/")[0] in kinds:
            session.print(f"{name}/{interface}")


def _packages(args: Namespace, session: Session) -> None:
    for name in sorted({name.split("/")[0] for name in types(_kinds(args))}):
        session.print(name)


def _or_from_stdin(text: str) -> str:
    """A type of argparse: an argument that is read from stdin when it is given as '-'."""
    if text == "-":
        if sys.stdin is None or sys.stdin.isatty():
            raise ArgumentError(None, "expected stdin pipe")
        text = sys.stdin.readline().strip()
    if not text:
        raise ArgumentError(None, "the passed value is empty")
    return text


def _show(args: Namespace, session: Session) -> None:
    if _path(args.type).endswith(".idl"):
        session.print(definition(args.type).rstrip())
        return
    lines = text.show(args.type, definition, not args.no_comments, args.all_comments)
    with failing(LookupError):  # a type that a field has, and that is not installed
        for line in lines:
            session.print(line)


def _proto(args: Namespace, session: Session) -> None:
    from course_kit.cli.ros2.messages import yaml_text

    name = args.type if args.type.count("/") != 1 else args.type.replace("/", "/msg/")
    _path(name)
    text = yaml_text.to_yaml(_part_to_fill_in(name)())
    session.print(text if args.no_quotes else f'"{text}"')


def _part_to_fill_in(type_name: str) -> Any:
    """The class of what a caller fills in: a message, a service's request, an action's goal."""
    import importlib

    package, kind, name = type_name.split("/")
    with failing(ImportError, AttributeError, say=lambda _: f"{type_name} is installed without its Python code"):
        cls = getattr(importlib.import_module(f"{package}.{kind}"), name)
    return {"msg": cls, "srv": getattr(cls, "Request", cls), "action": getattr(cls, "Goal", cls)}[kind]


def _only(words: str) -> Arguments:
    """The options that choose kinds of interfaces."""
    options = (("-m --only-msgs", "messages"), ("-s --only-srvs", "services"), ("-a --only-actions", "actions"))
    return all_of(*(flag(names, words.format(kind)) for names, kind in options))


def _type(example: str, **settings: Any) -> Arguments:
    return argument("type", f"the type, such as {example}", offering(lambda args: types()), **settings)


VERBS = {
    "list": Verb("list all types", _list, _only("only {}")),
    "package": Verb(
        "list the types of a package",
        _package,
        _only("only {}"),
        argument("package_name", "the package, such as std_msgs", offering(lambda args: installed())),
    ),
    "packages": Verb("list the packages that have types", _packages, _only("only those that have {}")),
    "proto": Verb(
        "print the fields of a type as YAML to fill in",
        _proto,
        _type("geometry_msgs/msg/Twist"),
        flag("--no-quotes", "print no quotes around it"),
    ),
    "show": Verb(
        "show the definition of a type",
        _show,
        one_of(
            flag("--all-comments", "print the comments of nested types, too"),
            flag("--no-comments", "print no comments and no empty lines"),
        ),
        _type("std_msgs/msg/String; - reads it from the standard input", type=_or_from_stdin),
    ),
}
