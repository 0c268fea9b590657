"""`ros2 pkg`: create, list, prefix, executables, xml."""

from __future__ import annotations

import os
from argparse import Namespace
from dataclasses import fields
from pathlib import Path
from typing import Any

from course_kit.cli.ros2.completion import package_names
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import CommandError, Verb, argument, did_you_mean, failing, flag, look_up
from course_kit.ros import packages

NOT_FOUND = "Package not found"
LONGEST_NAME = 200  # bytes: file systems take 255, with what is put before and after
NAME = argument("package_name", "the package", package_names)


def _list(args: Namespace, session: Session) -> None:
    for name in packages.package_names():
        session.print(name)


def _prefix(args: Namespace, session: Session) -> None:
    look = packages.share_directory if args.share else packages.package_prefix
    session.print(look_up(look, args.package_name, NOT_FOUND))


def _executables(args: Namespace, session: Session) -> None:
    wanted = args.package_name
    for name in packages.package_names() if wanted is None else [wanted]:
        for path in sorted(look_up(packages.executables, name), key=str):
            session.print(str(path) if args.full_path else f"{name} {path.name}")


def _xml(args: Namespace, session: Session) -> None:
    import xml.etree.ElementTree as ElementTree

    path = os.path.join(look_up(packages.share_directory, args.package_name, NOT_FOUND), "package.xml")
    if not os.path.isfile(path):
        raise CommandError("Package xml manifest not found")
    with failing(ElementTree.ParseError, say=lambda error: f"{path} is no XML: {error}"):
        root = ElementTree.parse(path).getroot()
    if args.tag is None:
        session.print(ElementTree.tostring(root, encoding="unicode"))
        return
    with failing(SyntaxError, KeyError, TypeError, say=lambda _: f"'{args.tag}' is no XML tag"):
        elements = root.findall(args.tag)
    if not elements:
        raise CommandError("XML tag not found", did_you_mean(args.tag, {element.tag for element in root}))
    for element in elements:
        session.print(str(element.text))


def _create(args: Namespace, session: Session) -> None:
    import shutil

    from course_kit.base.atomic_files import NotWritten, reason_of, write_whole
    from course_kit.cli.ros2.pkg import create

    if args.license == "?":
        session.print("\n".join(["Supported licenses:", *create.LICENSE_NAMES]))
        return
    package = _package(args, session)
    path = os.path.join(args.destination_directory, package.name)
    if os.path.exists(path):
        raise CommandError(
            f"\nAborted!\nThe directory already exists: {path}\nEither remove the directory or choose a different "
            "destination directory or package name"
        )
    for line in create.description(package, args.destination_directory):
        session.print(line)
    with failing(NotWritten, say=lambda error: f"unable to create {error.filename}: {reason_of(error)}"):
        try:
            create.make(package, args.destination_directory, session.print)
            text = create.license_text(package.license)
            if text is not None:
                write_whole(Path(path, "LICENSE"), text.encode())
        except BaseException:  # half a package would be in the way of the next attempt
            shutil.rmtree(path, ignore_errors=True)
            raise
    if text is None:
        session.print(create.license_warning(package.license))


def _package(args: Namespace, session: Session) -> Any:
    """The package that the arguments describe."""
    from course_kit.cli.ros2.pkg.create import Package

    for given in filter(None, (args.name, args.node, args.library)):
        is_path = given != os.path.basename(given) or given in (os.curdir, os.pardir)
        if is_path or len(given.encode()) > LONGEST_NAME:
            raise CommandError(f"'{given}' cannot be the name of a folder or file")
    if args.build_type == "ament_python" and args.name == "test":
        raise CommandError(
            "Aborted since 'ament_python' packages can't be named 'test'. Please choose a different package name."
        )
    if not args.name:
        raise CommandError("a package needs a name")
    if args.node and args.node == args.library:
        args.node += "_node"
        session.warn("[WARNING] node name can not be equal to the library name")
        session.warn(f"[WARNING] renaming node to {args.node}")
    args.maintainer = args.maintainer or _user()
    args.email = args.email or _email() or f"{args.maintainer}@todo.todo"
    return Package(**{field.name: getattr(args, field.name) for field in fields(Package)})


def _user() -> str:
    import getpass

    try:
        return getpass.getuser()
    except (KeyError, OSError):  # a user without a name, as in some containers
        return "user"


def _email() -> str:
    """The address that git knows the user by, or nothing."""
    import subprocess

    try:
        asked = subprocess.run(
            ["git", "config", "user.email"], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=5
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return asked.stdout.strip()


VERBS = {
    "create": Verb(
        "create a new package",
        _create,
        argument("name", "the name of the package", metavar="package_name"),
        argument(
            "--package-format --package_format",
            "of package.xml",
            dest="format",
            type=int,
            default=3,
            choices=[2, 3],
        ),
        argument("--description", "the description in package.xml", default="TODO: Package description"),
        argument(
            "--license",
            "any text; a known license gets a file LICENSE, too (? prints a list)",
            default="TODO: License declaration",
        ),
        argument("--destination-directory", "the folder in which the package's folder is made", default=os.curdir),
        argument(
            "--build-type", "the build type", default="ament_cmake", choices=["cmake", "ament_cmake", "ament_python"]
        ),
        argument("--dependencies", "packages that it depends on", nargs="+", default=[]),
        argument("--maintainer-email", "the maintainer's e-mail address", dest="email"),
        argument("--maintainer-name", "the maintainer's name", dest="maintainer"),
        argument("--node-name", "make an executable of that name", dest="node"),
        argument("--library-name", "make a library of that name", dest="library"),
    ),
    "executables": Verb(
        "list the executables of all packages, or of one",
        _executables,
        argument("package_name", "the package", package_names, nargs="?"),
        flag("--full-path", "print their paths"),
    ),
    "list": Verb("list the packages", _list),
    "prefix": Verb("show where a package is installed", _prefix, NAME, flag("--share", "its share directory")),
    "xml": Verb(
        "show the manifest of a package", _xml, NAME, argument("-t --tag", "only this element of it, such as version")
    ),
}
