"""The build at `pip install`: dependencies from the lock, and ROS packages that no wheel brings."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT))

from course_kit.setup.environment import compiler, pins  # noqa: E402
from course_kit.setup.environment.activation import has_package, sourced_ros  # noqa: E402
from course_kit.setup.environment.interpreter import INTERFACES, interfaces_to_compile, packages_to_install  # noqa: E402
from course_kit.setup.environment.levels import GRADING, TEST  # noqa: E402
from course_kit.setup.interfaces import rosidl  # noqa: E402

PREFIX = ROOT / "course_kit/setup/environment/prefix"
WATCHDOG = ROOT / "course_kit/base/shutdown/watchdog.c"
# The generators and the linker need these; their versions are those of the lock.
BUILD_WHEELS = (
    "ros-rosidl-generator-py", "ros-rosidl-typesupport-fastrtps-c", "ros-action-msgs", "ros-geometry-msgs", "empy",
    "numpy",
)  # fmt: skip
# Gives every Python of the environment what sourcing would. Python reads .pth files in the order of their names: this
# after the editable install's own, which starts with an underscore, and before ros_wheels_bootstrapper.pth, which
# restarts Python.
STARTUP = INTERFACES / "course_kit_environment.pth"
TOOLS = "share/course_kit/compiler"


class RosMetadata(MetadataHookInterface):
    """What depends on whether a sourced ROS 2 is used: it brings its own packages, and its own `ros2` command."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Fill in the dependencies of students, the extras for what others need, and the scripts."""
        ros = sourced_ros(os.environ)
        metadata["dependencies"] = pins.requirements(
            with_ros=ros is None, with_compiler=pins.compiler_is_wanted(os.environ)
        )
        metadata["optional-dependencies"] = {level: pins.added(level) for level in (GRADING, TEST)}
        has_command = ros is not None and has_package(ros.prefix, "ros2cli")
        ours = {} if has_command else {"ros2": "course_kit.cli.ros2.command:main"}
        metadata["scripts"] = {**ours, "course": "course_kit.classroom.course_command:main"}


class Packages(BuildHookInterface):
    """Install the ROS packages that no sourced ROS 2 brings; interfaces are compiled for the Python that runs this."""

    def interfaces(self) -> dict[str, Path]:
        """{name: folder} of what has to be compiled."""
        return {name: INTERFACES / name for name in interfaces_to_compile(sourced_ros(os.environ))}

    def dependencies(self) -> list[str]:
        """The packages that compiling needs."""
        wheels = BUILD_WHEELS if self.interfaces() else ()
        has_compiler = compiler.of_the_machine(os.environ)
        return pins.versions(wheels if has_compiler else (*wheels, compiler.WHEEL))

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile the interfaces and add the packages to the wheel."""
        work = ROOT / "build" / f"rosidl-{sysconfig.get_config_var('SOABI')}"
        work.mkdir(parents=True, exist_ok=True)
        include, shared = {str(STARTUP): STARTUP.name}, build_data["shared_data"]
        for path in sorted(p for p in PREFIX.rglob("*") if p.is_file()):
            shared[str(path)] = str(path.relative_to(PREFIX))
        if pins.compiler_is_wanted(os.environ):
            shared |= self._tools(work / "compiler")
        shared[str(self._watchdog(work))] = "lib/course_kit/watchdog.so"
        self._force_platform_tag(build_data)
        interfaces = self.interfaces()
        if interfaces:
            for name, folder in self._compiled(interfaces, work).items():
                modules = [p for p in sorted(folder.rglob("*")) if p.suffix in (".py", ".so")]
                include |= {str(p): f"{name}/{p.relative_to(folder)}" for p in modules}
        for name in packages_to_install(sourced_ros(os.environ)):
            python = INTERFACES / name / "python"  # what is imported by its name; its code is in course_kit
            include |= {str(p): str(p.relative_to(python)) for p in sorted(python.rglob("*.py"))}
            shared |= self._share(name, INTERFACES / name, work)
        build_data["shared_data"] = shared
        build_data["force_include_editable" if version == "editable" else "force_include"].update(include)

    @staticmethod
    def _tools(folder: Path) -> dict[str, str]:
        """The commands by which CMake finds the compiler that comes as a wheel."""
        folder.mkdir(exist_ok=True)
        compiler.write_tools(folder, to_prefix="../" * len(Path(TOOLS).parts))
        return {str(p): f"{TOOLS}/{p.relative_to(folder)}" for p in folder.rglob("*") if p.is_file()}

    @staticmethod
    def _watchdog(work: Path) -> Path:
        """Compile what keeps a process from hanging."""
        made = work / "watchdog.so"
        command = [*compiler.find(work).c, "-O2", "-shared", "-fPIC", "-pthread", str(WATCHDOG), "-o", str(made)]
        subprocess.run(command, check=True)
        return made

    def _compiled(self, packages: dict[str, Path], work: Path) -> dict[str, Path]:
        """Compile, unless the same definitions were compiled before."""
        digest = hashlib.sha256(Path(rosidl.__file__).read_bytes() + Path(compiler.__file__).read_bytes())
        for path in sorted(p for folder in packages.values() for p in folder.rglob("*") if p.is_file()):
            digest.update(str(path).encode() + path.read_bytes())
        digest.update("".join(pins.versions(BUILD_WHEELS)).encode())
        stamp = work / "stamp"
        if stamp.exists() and stamp.read_text() == digest.hexdigest():
            return {name: work / "rosidl_generator_py" / name for name in packages}
        self.app.display_info(f"compiling ROS 2 interfaces: {', '.join(packages)}")
        built = rosidl.build(packages, work)
        stamp.write_text(digest.hexdigest())
        return built

    @staticmethod
    def _share(name: str, source: Path, work: Path) -> dict[str, str]:
        """share/<package>, lib/<package> and the ament index, as a package built by colcon has them."""
        files = sorted(p for kind in rosidl.KINDS for p in (source / kind).glob(f"*.{kind}"))
        share = {str(p): f"share/{name}/{p.relative_to(source)}" for p in [*files, source / "package.xml"]}
        generated = work / "share" / name
        share |= {str(p): f"share/{name}/{p.relative_to(generated)}" for p in sorted(generated.rglob("*.*"))}
        share |= {str(p): f"share/{name}/launch/{p.name}" for p in sorted((source / "launch").glob("*.launch.*"))}
        # What `ros2 run` and launch files start: scripts that call course_kit.
        share |= {str(p): f"lib/{name}/{p.name}" for p in sorted((source / "lib").glob("*"))}
        markers = {"packages": ""}
        if files:
            markers["rosidl_interfaces"] = "".join(f"{p.relative_to(source)}\n" for p in files)
        for kind, text in markers.items():
            marker = work / f"{kind}-{name}"
            marker.write_text(text)
            share[str(marker)] = f"share/ament_index/resource_index/{kind}/{name}"
        return share

    def _force_platform_tag(self, build_data: dict[str, Any]) -> None:
        """Mark the wheel as made for this Python, so that another one compiles again."""
        builder = self.build_config.builder
        tag = builder.get_best_matching_tag()
        build_data.update(pure_python=False, tag=tag)
        builder.get_default_tag = lambda: tag  # editable wheels ignore build_data["tag"]
