"""Substitutions that look packages up: those of launch_ros."""

from __future__ import annotations

import os
import shutil

from course_kit.launching.context import LaunchContext
from course_kit.launching.substitutions import Composed, SomeSubstitutions, SubstitutionFailure
from course_kit.programs import packages


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


class FindPackage(Composed):
    """A folder of a package."""

    shown = "{type}(pkg={package})"

    def __init__(self, package: SomeSubstitutions) -> None:
        super().__init__(package=package)

    def _text(self, context: LaunchContext, package: str) -> str:
        return self.find(package)

    def find(self, name: str) -> str:
        """The folder of the package of that name."""
        raise NotImplementedError


class FindPackagePrefix(FindPackage):
    """The prefix of a package."""

    find = staticmethod(package_prefix)


class FindPackageShare(FindPackage):
    """The share directory of a package."""

    def find(self, name: str) -> str:
        """The share directory of the package of that name."""
        return os.path.join(package_prefix(name), "share", name)


class ExecutableInPackage(Composed):
    """The path of an executable of a package."""

    shown = "ExecInPkg(pkg={package}, exec={executable})"

    def __init__(self, executable: SomeSubstitutions, package: SomeSubstitutions) -> None:
        super().__init__(executable=executable, package=package)

    def _text(self, context: LaunchContext, executable: str, package: str) -> str:
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
