"""Creates a package for `ros2 pkg create`: its folders and files, in the order in which they are announced."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from course_kit.base.atomic_files import write_whole, writing

TEMPLATES = Path(__file__).with_name("templates")
# Licenses that come with their text, in the order of the real command.
LICENSE_NAMES = (
    "Apache-2.0",
    "BSL-1.0",
    "BSD-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "GPL-3.0-only",
    "LGPL-3.0-only",
    "MIT",
    "MIT-0",
)
TEST_DEPENDENCIES = {
    "ament_cmake": ("ament_lint_auto", "ament_lint_common"),
    "ament_python": ("ament_copyright", "ament_flake8", "ament_pep257", "python3-pytest"),
}


@dataclass(frozen=True)
class Package:
    """A package that is to be made."""

    name: str
    build_type: str
    format: int
    description: str
    maintainer: str
    email: str
    license: str
    dependencies: Sequence[str] = ()
    node: str | None = None
    library: str | None = None

    def filled(self, template: str) -> str:
        """The text of a template file below `templates/`, named without its suffix."""
        values = {
            **vars(self),
            "class": "".join((self.library or "").replace("_", " ").title().split()),
            "test_dependencies": TEST_DEPENDENCIES.get(self.build_type, ()),
        }
        return _templates().get_template(f"{template}.template").render(values)


@cache
def _templates() -> Environment:
    """The templates; values are in [[…]], because CMake has braces of its own."""
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        variable_start_string="[[",
        variable_end_string="]]",
        trim_blocks=True,
        keep_trailing_newline=True,
        undefined=StrictUndefined,
    )
    environment.filters |= {"xml": escape, "attribute": quoteattr, "py": repr}
    return environment


def description(package: Package, destination: str) -> list[str]:
    """The lines that say what is going to be made, and where."""
    lines = [
        "going to create a new package",
        f"package name: {package.name}",
        f"destination directory: {os.path.abspath(destination)}",
        f"package format: {package.format}",
        "version: 0.0.0",
        f"description: {package.description}",
        f"maintainer: {[f'{package.maintainer} <{package.email}>']}",
        f"licenses: {[package.license]}",
        f"build type: {package.build_type}",
        f"dependencies: {list(package.dependencies)}",
    ]
    lines += [f"node_name: {package.node}"] if package.node else []
    return lines + ([f"library_name: {package.library}"] if package.library else [])


def make(package: Package, destination: str, say: Callable[[str], None]) -> None:
    """Make everything, in the real command's order; `say` gets the line that announces each folder and file.

    Raises NotWritten.
    """
    name, node, library = package.name, package.node, package.library
    root = os.path.join(destination, name)

    def folder(*path: str) -> None:
        say(f"creating folder {os.path.join(root, *path)}")
        with writing(os.path.join(root, *path)):
            os.makedirs(os.path.join(root, *path), exist_ok=True)

    def file(path: str, template: str = "") -> None:
        say(f"creating {os.path.join(root, path)}")
        write_whole(Path(root, path), package.filled(template).encode() if template else b"")

    folder()
    file("package.xml", "package.xml")
    if package.build_type == "ament_python":
        say("creating source folder")
        folder(name)
        for setup in ("setup.py", "setup.cfg"):
            file(setup, f"ament_python/{setup}")
        folder("resource")
        file(f"resource/{name}")
        file(f"{name}/__init__.py")
        folder("test")
        for test in ("test_copyright.py", "test_flake8.py", "test_pep257.py"):
            file(f"test/{test}", f"ament_python/{test}")
        if node:
            file(f"{name}/{node}.py", "ament_python/node.py")
        if library:
            folder(name, library)
            file(f"{name}/{library}/__init__.py")
    else:
        say("creating source and include folder")
        folder("src")
        folder("include", name)
        file("CMakeLists.txt", f"{package.build_type}/CMakeLists.txt")
        if package.build_type == "cmake":
            for config in ("Config.cmake.in", "ConfigVersion.cmake.in"):
                file(f"{name}{config}", f"cmake/{config}")
        if node:
            file(f"src/{node}.cpp", "cpp/node.cpp")
        if library:
            file(f"include/{name}/{library}.hpp", "cpp/library.hpp")
            file(f"src/{library}.cpp", "cpp/library.cpp")
            file(f"include/{name}/visibility_control.h", "cpp/visibility_control.h")


def license_text(name: str) -> str | None:
    """The text of a license; None if it does not come with one."""
    if name not in LICENSE_NAMES:
        return None
    # The LGPL adds permissions to the GPL, and goes with its text.
    names = [name, "GPL-3.0-only"] if name == "LGPL-3.0-only" else [name]
    return "\n".join((TEMPLATES / "licenses" / n).read_text(encoding="utf-8") for n in names)


def license_warning(name: str) -> str:
    """What is said of a license whose text is not known."""
    return (
        f"\n[WARNING]: Unknown license '{name}'.  This has been set in the package.xml, but no LICENSE file has been "
        "created.\nIt is recommended to use one of the ament license identitifers:\n" + "\n".join(LICENSE_NAMES)
    )
