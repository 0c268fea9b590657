"""`ros2 pkg`: create, list, prefix, executables, xml."""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from typing import Any

from course_kit.programs import packages
from course_kit.ros2.completion import package_names
from course_kit.ros2.session import Session
from course_kit.ros2.verbs import CommandError, Verb, add_flag, add_offered, did_you_mean

NOT_FOUND = "Package not found"


def _package_argument(parser: ArgumentParser, nargs: str | None = None) -> None:
    add_offered(parser, "package_name", package_names, "The package name", nargs=nargs)


def _found(look: Callable[[str], Any], name: str, message: str = NOT_FOUND) -> Any:
    """What a look-up of a package gives; a failure of the verb if there is no such package."""
    try:
        return look(name)
    except LookupError:
        raise CommandError(message, did_you_mean(name, packages.package_names())) from None


def _list(args: Namespace, session: Session) -> None:
    for name in packages.package_names():
        session.print(name)


def _prefix_arguments(parser: ArgumentParser) -> None:
    _package_argument(parser)
    add_flag(parser, "--share", "Show share directory for the package")


def _prefix(args: Namespace, session: Session) -> None:
    look = packages.share_directory if args.share else packages.package_prefix
    session.print(_found(look, args.package_name))


def _executables_arguments(parser: ArgumentParser) -> None:
    _package_argument(parser, nargs="?")
    add_flag(parser, "--full-path", "Show full path of each executable")


def _executables(args: Namespace, session: Session) -> None:
    wanted = args.package_name
    for name in packages.package_names() if wanted is None else [wanted]:
        for path in sorted(_found(packages.executables, name, f"Package '{name}' not found"), key=str):
            session.print(str(path) if args.full_path else f"{name} {path.name}")


def _xml_arguments(parser: ArgumentParser) -> None:
    _package_argument(parser)
    parser.add_argument("-t", "--tag", help="The XML tag to output, e.g. version")


def _xml(args: Namespace, session: Session) -> None:
    import xml.etree.ElementTree as ElementTree

    path = os.path.join(_found(packages.share_directory, args.package_name), "package.xml")
    if not os.path.isfile(path):
        raise CommandError("Package xml manifest not found")
    try:
        root = ElementTree.parse(path).getroot()
    except ElementTree.ParseError as error:
        raise CommandError(f"{path} is no XML: {error}") from None
    if args.tag is None:
        session.print(ElementTree.tostring(root, encoding="unicode"))
        return
    elements = root.findall(args.tag)
    if not elements:
        raise CommandError("XML tag not found", did_you_mean(args.tag, {element.tag for element in root}))
    for element in elements:
        session.print(str(element.text))


def _create_arguments(parser: ArgumentParser) -> None:
    parser.add_argument("package_name", help="The package name")
    parser.add_argument(
        "--package-format",
        "--package_format",
        type=int,
        default=3,
        choices=[2, 3],
        help="The package.xml format.",
    )
    parser.add_argument(
        "--description", default="TODO: Package description", help="The description given in the package.xml"
    )
    parser.add_argument(
        "--license",
        default="TODO: License declaration",
        help="The license attached to this package; this can be an arbitrary string, but a LICENSE file will only be "
        "generated if it is one of the supported licenses (pass '?' to get a list)",
    )
    parser.add_argument(
        "--destination-directory", default=os.curdir, help="Directory where to create the package directory"
    )
    parser.add_argument(
        "--build-type",
        default="ament_cmake",
        choices=["cmake", "ament_cmake", "ament_python"],
        help="The build type to process the package with",
    )
    parser.add_argument("--dependencies", nargs="+", default=[], help="list of dependencies")
    parser.add_argument("--maintainer-email", help="email address of the maintainer of this package")
    parser.add_argument("--maintainer-name", help="name of the maintainer of this package")
    parser.add_argument("--node-name", help="name of the empty executable")
    parser.add_argument("--library-name", help="name of the empty library")


def _create(args: Namespace, session: Session) -> None:
    from course_kit.ros2.pkg import create

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
    try:
        for step in create.steps(package, args.destination_directory):
            session.print(step.line)
            step.take()
        text = create.license_text(package.license)
        if text is None:
            session.print(create.license_warning(package.license))
        else:
            create.Step("", os.path.join(path, "LICENSE"), text).take()
    except OSError as error:
        raise CommandError(f"unable to create {error.filename}: {error.strerror}") from None


def _package(args: Namespace, session: Session) -> Any:
    """The package that the arguments describe."""
    from course_kit.ros2.pkg.create import Package

    name = args.package_name
    for given in filter(None, (name, args.node_name, args.library_name)):
        if given != os.path.basename(given) or given in (os.curdir, os.pardir):
            raise CommandError(f"'{given}' cannot be the name of a folder or file")
    if args.build_type == "ament_python" and name == "test":
        raise CommandError(
            "Aborted since 'ament_python' packages can't be named 'test'. Please choose a different package name."
        )
    if not name:
        raise CommandError("a package needs a name")
    node = args.node_name
    if node and node == args.library_name:
        node += "_node"
        session.warn("[WARNING] node name can not be equal to the library name")
        session.warn(f"[WARNING] renaming node to {node}")
    maintainer = args.maintainer_name or _user()
    return Package(
        name=name,
        build_type=args.build_type,
        format=args.package_format,
        description=args.description,
        maintainer=maintainer,
        email=args.maintainer_email or _email() or f"{maintainer}@todo.todo",
        license=args.license,
        dependencies=tuple(args.dependencies),
        node=node,
        library=args.library_name,
    )


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
    "create": Verb("Create a new ROS 2 package", _create, _create_arguments),
    "executables": Verb("Output a list of package specific executables", _executables, _executables_arguments),
    "list": Verb("Output a list of available packages", _list),
    "prefix": Verb("Output the prefix path of a package", _prefix, _prefix_arguments),
    "xml": Verb("Output the XML of the package manifest or a specific tag", _xml, _xml_arguments),
}
