"""The terminals that programs of the robot are started in: good ones, and such as students have had."""

from __future__ import annotations

import atexit
import functools
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

from course_kit.base.atomic_files import write_whole
from course_kit.exercises.domains import reserve_domain
from course_kit.ros.spinning.context import RANGE
from course_kit.setup.colcon import sourcing
from course_kit.setup.environment.activation import PROFILE, PROFILE_VARIABLES, split_paths

ROBOT = Path(__file__).with_name("robot")  # where the package `patrol` is installed, as colcon's install folder
STOCK_LEASE = 20  # seconds that DDS keeps a participant which says nothing any more, unless it is told otherwise

Environment = dict[str, str]


def source_robot() -> None:
    """Have this process and its children find the package `patrol`, as sourcing its workspace would."""
    others = [entry for entry in split_paths(os.environ.get("AMENT_PREFIX_PATH", "")) if entry != str(ROBOT)]
    os.environ["AMENT_PREFIX_PATH"] = os.pathsep.join([str(ROBOT), *others])


def executable(program: str) -> Path:
    """The file that `ros2 run patrol …` runs. RuntimeError if its right to be run was lost on the way here."""
    path = ROBOT / "lib/patrol" / program
    if not os.access(path, os.X_OK):
        raise RuntimeError(f"{path} is not executable. Get the course anew, or write: chmod +x {path}")
    return path


_domain = functools.cache(reserve_domain)  # another domain, the same for this process


def _without(environ: Mapping[str, str], variable: str) -> Environment:
    return {name: value for name, value in environ.items() if name != variable}


def _conda_first(environ: Mapping[str, str]) -> Environment:
    """A terminal in which a Python environment without ROS 2 stands first on PATH, as conda's `base` does."""
    folder = _folder() / "miniconda3"
    if not folder.exists():
        new = _folder() / "new"
        shutil.rmtree(new, ignore_errors=True)
        (new / "bin").mkdir(parents=True)
        (new / "conda-meta").mkdir()
        base = Path(sys.base_prefix, "bin", f"python{sys.version_info.major}.{sys.version_info.minor}")
        (new / "pyvenv.cfg").write_text(f"home = {base.parent}\ninclude-system-site-packages = false\n")
        for name in ("python", "python3"):
            (new / "bin" / name).symlink_to(base)
        new.rename(folder)
    # A sourced ROS 2 lends its modules to every Python by PYTHONPATH; conda's, of another version, cannot load them.
    without = _without(environ, "PYTHONPATH")
    path = os.pathsep.join([str(folder / "bin"), environ.get("PATH", "")])
    return {**without, "PATH": path, "CONDA_PREFIX": str(folder), "CONDA_DEFAULT_ENV": "base"}


def _long_lease(environ: Mapping[str, str]) -> Environment:
    """A terminal without the course's short lease, so that a killed program stays listed as long as on a robot."""
    profile = _folder() / "stock_lease.xml"
    if not profile.exists():
        lease = "<leaseDuration><sec>{}</sec></leaseDuration>"
        text = Path(PROFILE).read_text()
        if lease.format(5) not in text:
            raise RuntimeError(f"{PROFILE} has another lease than the fault lab expects")
        write_whole(profile, text.replace(lease.format(5), lease.format(STOCK_LEASE)).encode())
    return {**environ, **dict.fromkeys(PROFILE_VARIABLES, str(profile))}


TERMINALS: dict[str, Callable[[Mapping[str, str]], Environment]] = {
    "good": dict,
    "not sourced": lambda environ: sourcing.without(environ, ROBOT),
    "other domain": lambda environ: {**environ, "ROS_DOMAIN_ID": str(_domain())},
    "no discovery": lambda environ: {**_without(environ, "ROS_LOCALHOST_ONLY"), RANGE: "OFF"},
    "conda": _conda_first,
    "long lease": _long_lease,
}


@functools.cache
def _folder() -> Path:
    """A folder of this process, which goes with it."""
    folder = tempfile.TemporaryDirectory(prefix="course-kit-faults-")
    atexit.register(folder.cleanup)
    return Path(folder.name)
