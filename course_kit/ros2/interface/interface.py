"""`ros2 interface`: list, show, package, packages, proto; from the definitions that are installed, without ROS."""

from __future__ import annotations

import argparse
import os
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Sequence
from typing import Any

from course_kit.programs import packages
from course_kit.ros2.completion import offering
from course_kit.ros2.interface import text
from course_kit.ros2.interface.text import KINDS
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError, Verb, add_flag, add_offered, did_you_mean

INDEX = os.path.join("share", "ament_index", "resource_index", "rosidl_interfaces")
HEADINGS = {"msg": "Messages:", "srv": "Services:", "action": "Actions:"}
OPTIONS = {"msg": "only_msgs", "srv": "only_srvs", "action": "only_actions"}
Interfaces = dict[str, list[str]]


def installed() -> Interfaces:
    """{package: ['msg/String', ...]} of every package that has interfaces, sorted; of two the first prefix counts."""
    found: Interfaces = {}
    for prefix in packages.prefixes():
        index = prefix / INDEX
        for package in sorted(os.listdir(index)) if index.is_dir() else ():
            if package not in found and not package.startswith("."):
                found[package] = _names((index / package).read_text())
    return dict(sorted(found.items()))


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
    if len(parts) != 3:
        raise ValueError(f"Invalid name '{type_name}'. Expected three parts separated by '/'")
    if not all(parts):
        raise ValueError(f"Invalid name '{type_name}'. Must not contain empty parts")
    if ".." in parts:
        raise ValueError(f"Invalid name '{type_name}'. Must not contain '..'")
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


def _definition(type_name: str) -> str:
    with open(path(type_name), encoding="utf-8") as file:
        return file.read()


def _looked_up(look: Callable[[], Any], name: str) -> Any:
    """What a look-up gives; its failure as one of the verb, with the type that may be meant."""
    try:
        return look()
    except (LookupError, ValueError) as error:
        near = text.near_type(name, types())
        if near is None and not name.startswith(tuple(f"{package}/" for package in installed())):
            raise CommandError(str(error), did_you_mean(name.split("/")[0], installed())) from None
        raise CommandError(str(error), f"Did you mean {near}?" if near else None) from None


_offer_types = offering(lambda args: types())
_offer_packages = offering(lambda args: installed())


def _kind_arguments(parser: ArgumentParser, words: str) -> None:
    parser.add_argument("-m", "--only-msgs", action="store_true", help=words.format("message"))
    parser.add_argument("-s", "--only-srvs", action="store_true", help=words.format("service"))
    parser.add_argument("-a", "--only-actions", action="store_true", help=words.format("action"))


def _kinds(args: Namespace) -> list[str]:
    return [kind for kind in KINDS if getattr(args, OPTIONS[kind])] or list(KINDS)


def _list_arguments(parser: ArgumentParser) -> None:
    _kind_arguments(parser, "Print out only the {} types")


def _list(args: Namespace, session: Session) -> None:
    for kind in _kinds(args):
        session.print("\n".join([HEADINGS[kind], *(f"    {name}" for name in types([kind]))]))


def _package_arguments(parser: ArgumentParser) -> None:
    _list_arguments(parser)
    add_offered(
        parser,
        "package_name",
        _offer_packages,
        "Name of the ROS package (e.g. 'example_interfaces')",
    )


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


def _packages_arguments(parser: ArgumentParser) -> None:
    _kind_arguments(parser, "Only list packages that generate {}s")


def _packages(args: Namespace, session: Session) -> None:
    for name in sorted({name.split("/")[0] for name in types(_kinds(args))}):
        session.print(name)


class _FromStdin(argparse.Action):
    """An argument that is read from stdin when it is given as '-'."""

    def __call__(
        self, parser: ArgumentParser, namespace: Namespace, values: Any, option_string: str | None = None
    ) -> None:
        if values == "-":
            if sys.stdin is None or sys.stdin.isatty():
                parser.error("expected stdin pipe")
            values = sys.stdin.readline().strip()
        if not values:
            parser.error("the passed value is empty")
        setattr(namespace, self.dest, values)


def _show_arguments(parser: ArgumentParser) -> None:
    comments = parser.add_mutually_exclusive_group()
    add_flag(comments, "--all-comments", "Show all comments, including for nested interface definitions")
    add_flag(comments, "--no-comments", "Show no comments or whitespace")
    add_offered(
        parser,
        "type",
        _offer_types,
        "Show an interface definition (e.g. 'example_interfaces/msg/String'). Passing '-' reads the argument "
        "from stdin (e.g. 'ros2 topic type /chatter | ros2 interface show -').",
        action=_FromStdin,
    )


def _show(args: Namespace, session: Session) -> None:
    file = _looked_up(lambda: path(args.type), args.type)
    if file.endswith(".idl"):
        session.print(_definition(args.type).rstrip())
        return
    lines = text.show(args.type, _definition, not args.no_comments, args.all_comments)
    try:
        for line in lines:
            session.print(line)
    except LookupError as error:  # a type that a field has, and that is not installed
        raise CommandError(str(error)) from None


def _proto_arguments(parser: ArgumentParser) -> None:
    add_offered(
        parser,
        "type",
        _offer_types,
        "Show an interface definition (e.g. 'example_interfaces/msg/String')",
    )
    add_flag(parser, "--no-quotes", "if true output has no outer quotes.")


def _proto(args: Namespace, session: Session) -> None:
    from course_kit.ros2.messages import yaml_text

    name = args.type if args.type.count("/") != 1 else args.type.replace("/", "/msg/")
    _looked_up(lambda: path(name), name)
    text = yaml_text.to_yaml(_part_to_fill_in(name)())
    session.print(text if args.no_quotes else f'"{text}"')


def _part_to_fill_in(type_name: str) -> Any:
    """The class of what a caller fills in: a message, a service's request, an action's goal."""
    import importlib

    package, kind, name = type_name.split("/")
    try:
        cls = getattr(importlib.import_module(f"{package}.{kind}"), name)
    except (ImportError, AttributeError):
        raise CommandError(f"{type_name} is installed without its Python code") from None
    return {"msg": cls, "srv": getattr(cls, "Request", cls), "action": getattr(cls, "Goal", cls)}[kind]


VERBS = {
    "list": Verb("List all interface types available", _list, _list_arguments),
    "package": Verb("Output a list of available interface types within one package", _package, _package_arguments),
    "packages": Verb("Output a list of packages that provide interfaces", _packages, _packages_arguments),
    "proto": Verb("Output an interface prototype", _proto, _proto_arguments),
    "show": Verb("Output the interface definition", _show, _show_arguments),
}
