"""Substitutions that look packages up: those of launch_ros."""

from __future__ import annotations

import os
import shutil

from course_kit.cli.launching.context import LaunchContext
from course_kit.cli.launching.substitutions import Composed, SomeSubstitutions, SubstitutionFailure
from course_kit.ros import packages


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

    find = staticmethod(packages.package_prefix)


class FindPackageShare(FindPackage):
    """The share directory of a package."""

    find = staticmethod(packages.share_directory)


class ExecutableInPackage(Composed):
    """The path of an executable of a package."""

    shown = "ExecInPkg(pkg={package}, exec={executable})"

    def __init__(self, executable: SomeSubstitutions, package: SomeSubstitutions) -> None:
        super().__init__(executable=executable, package=package)

    def _text(self, context: LaunchContext, executable: str, package: str) -> str:
        prefix = packages.package_prefix(package)
        folder = os.path.join(prefix, "lib", package)
        if not os.path.exists(folder):
            raise SubstitutionFailure(f"the package '{package}' has no executables: there is no folder '{folder}'")
        path = shutil.which(executable, path=folder)
        if path is None:
            raise SubstitutionFailure(f"no executable '{executable}' is in '{folder}'")
        return path
