"""Substitutions that look packages up: those of launch_ros."""

from __future__ import annotations

import os
import shutil
from typing import TYPE_CHECKING

from course_kit.launching.substitutions import (
    SomeSubstitutions,
    Substitution,
    SubstitutionFailure,
    described,
    normalize,
    perform,
)
from course_kit.programs import packages

if TYPE_CHECKING:
    from course_kit.launching.context import LaunchContext


class PackageNotFoundError(KeyError):
    """No prefix has the package; prints as the one of ament_index_python does, in quotes."""

    def __init__(self, name: str) -> None:
        super().__init__(f"package '{name}' not found, searching: {[str(p) for p in packages.prefixes()]}")


def package_prefix(name: str) -> str:
    """The prefix of a package. PackageNotFoundError if there is none."""
    try:
        return packages.package_prefix(name)
    except LookupError:
        raise PackageNotFoundError(name) from None


class FindPackage(Substitution):
    """A folder of a package."""

    def __init__(self, package: SomeSubstitutions) -> None:
        self.package = normalize(package)

    def describe(self) -> str:
        return f"{type(self).__name__}(pkg={described(self.package)})"

    def perform(self, context: LaunchContext) -> str:
        return self.find(perform(context, self.package))

    def find(self, package: str) -> str:
        """The folder of the package of that name."""
        raise NotImplementedError


class FindPackagePrefix(FindPackage):
    """The prefix of a package."""

    def find(self, package: str) -> str:
        return package_prefix(package)


class FindPackageShare(FindPackage):
    """The share directory of a package."""

    def find(self, package: str) -> str:
        return os.path.join(package_prefix(package), "share", package)


class ExecutableInPackage(Substitution):
    """The path of an executable of a package."""

    def __init__(self, executable: SomeSubstitutions, package: SomeSubstitutions) -> None:
        self.executable = normalize(executable)
        self.package = normalize(package)

    def describe(self) -> str:
        return f"ExecInPkg(pkg={described(self.package)}, exec={described(self.executable)})"

    def perform(self, context: LaunchContext) -> str:
        executable, package = perform(context, self.executable), perform(context, self.package)
        prefix = package_prefix(package)
        folder = os.path.join(prefix, "lib", package)
        if not os.path.exists(folder):
            raise SubstitutionFailure(
                f"package '{package}' found at '{prefix}', but libexec directory '{folder}' does not exist"
            )
        path = shutil.which(executable, path=folder)
        if path is None:
            raise SubstitutionFailure(f"executable '{executable}' not found on the libexec directory '{folder}' ")
        return path
