"""What `ros2 pkg create` makes: the folders and files of a new package, in the order in which they are announced."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import escape, quoteattr

from jinja2 import Environment, FileSystemLoader, StrictUndefined

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
    dependencies: tuple[str, ...] = ()
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


class Step(NamedTuple):
    """A line to print, and the folder (no content) or file that is made then, if any."""

    line: str
    path: str = ""
    content: str | None = None

    def take(self) -> None:
        """Make what the step is about."""
        if self.content is not None:
            with open(self.path, "w", encoding="utf-8") as file:
                file.write(self.content)
        elif self.path:
            os.makedirs(self.path, exist_ok=True)


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


def steps(package: Package, destination: str) -> Iterator[Step]:
    """Everything that has to be made, in order."""
    root = os.path.join(destination, package.name)
    yield _folder(root)
    yield _file(os.path.join(root, "package.xml"), package.filled("package.xml"))
    if package.build_type == "ament_python":
        yield from _python_steps(package, root)
    else:
        yield from _cmake_steps(package, root)


def _folder(path: str) -> Step:
    return Step(f"creating folder {path}", path)


def _file(path: str, content: str) -> Step:
    return Step(f"creating {path}", path, content)


def _python_steps(package: Package, root: str) -> Iterator[Step]:
    source, resource, test = (os.path.join(root, name) for name in (package.name, "resource", "test"))
    yield Step("creating source folder")
    yield _folder(source)
    for name in ("setup.py", "setup.cfg"):
        yield _file(os.path.join(root, name), package.filled(f"ament_python/{name}"))
    yield _folder(resource)
    yield _file(os.path.join(resource, package.name), "")
    yield _file(os.path.join(source, "__init__.py"), "")
    yield _folder(test)
    for name in ("test_copyright.py", "test_flake8.py", "test_pep257.py"):
        yield _file(os.path.join(test, name), package.filled(f"ament_python/{name}"))
    if package.node:
        yield _file(os.path.join(source, f"{package.node}.py"), package.filled("ament_python/node.py"))
    if package.library:
        yield _folder(os.path.join(source, package.library))
        yield _file(os.path.join(source, package.library, "__init__.py"), "")


def _cmake_steps(package: Package, root: str) -> Iterator[Step]:
    source, include = os.path.join(root, "src"), os.path.join(root, "include", package.name)
    yield Step("creating source and include folder")
    yield _folder(source)
    yield _folder(include)
    yield _file(os.path.join(root, "CMakeLists.txt"), package.filled(f"{package.build_type}/CMakeLists.txt"))
    if package.build_type == "cmake":
        for name in ("Config.cmake.in", "ConfigVersion.cmake.in"):
            yield _file(os.path.join(root, package.name + name), package.filled(f"cmake/{name}"))
    if package.node:
        yield _file(os.path.join(source, f"{package.node}.cpp"), package.filled("cpp/node.cpp"))
    if package.library:
        yield _file(os.path.join(include, f"{package.library}.hpp"), package.filled("cpp/library.hpp"))
        yield _file(os.path.join(source, f"{package.library}.cpp"), package.filled("cpp/library.cpp"))
        yield _file(os.path.join(include, "visibility_control.h"), package.filled("cpp/visibility_control.h"))


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
