"""Checks of the machine: operating system, C library, processor, memory, disk."""

from __future__ import annotations

import os
import platform
import re
import shutil
from collections.abc import Mapping
from pathlib import Path

from course_kit.setup.environment.compiler import OLDEST_GLIBC
from course_kit.setup.environment.report import Check, fail, passed, warn

NEEDED_MEMORY = 1000  # MB: JupyterLab, two kernels, a browser page
NEEDED_DISK = 1200  # MB: a student's environment, what is compiled, the installer's cache
SPARE_DISK = 200  # MB: recordings, bags, workspaces of the chapters
# Once apt knows ROS's packages, by the steps of https://docs.ros.org/en/jazzy/Installation/Ubuntu-Install-Debs.html.
APT_JAZZY = (
    "sudo apt-get install -y ros-jazzy-ros-base ros-jazzy-turtlesim ros-jazzy-example-interfaces python3-venv"
    " && source /opt/ros/jazzy/setup.bash"
)


def operating_system(system: str, release: Mapping[str, str], kernel: str = "") -> Check:
    """Linux, also in a container or in WSL 2. `release` holds the fields of /etc/os-release."""
    if system != "Linux":
        reason = "the packages of ROS 2 that the course installs are made for Linux"
        cure = "on Windows: wsl --install Ubuntu-24.04; on macOS: a Linux virtual machine or container"
        return fail({"Darwin": "macOS"}.get(system, system), reason, cure)
    distribution = release.get("PRETTY_NAME", "Linux")
    if is_wsl(kernel) and "wsl2" not in kernel.lower():
        reason = "WSL 1 has no Linux kernel, and DDS finds no other node there"
        command = f"wsl --set-version {release.get('NAME', 'Ubuntu')} 2"
        cure = f"in PowerShell, with the name that wsl --list shows: {command}"
        return fail(f"{distribution} in WSL 1", reason, cure)
    return passed(f"{distribution} in WSL 2" if is_wsl(kernel) else distribution)


def is_wsl(kernel: str) -> bool:
    """Return True if this is Linux in Windows: its kernel is called 5.15.90.1-microsoft-standard-WSL2."""
    return "microsoft" in kernel.lower()


def os_release() -> dict[str, str]:
    """The fields of /etc/os-release; empty where there is none."""
    try:
        return platform.freedesktop_os_release()
    except OSError:
        return {}


def c_library_version() -> str:
    """For example "glibc 2.36"; empty if it is not the GNU C library."""
    return " ".join(platform.libc_ver()).strip()


def c_library(version: str) -> Check:
    """At least glibc 2.28, which the ROS 2 wheels are built for. `version` as "glibc 2.36", or empty."""
    found = re.match(r"glibc (\d+)\.(\d+)", version)
    if found and tuple(map(int, found.groups())) >= OLDEST_GLIBC:
        return passed(version)
    needed = ".".join(map(str, OLDEST_GLIBC))
    reason = f"the wheels of ROS 2 need glibc {needed} or newer; Alpine's musl does not run them"
    cure = "use a newer distribution: Debian 10, Ubuntu 20.04, Fedora 29 and later have it"
    return fail(version or "not the GNU C library", reason, cure)


def architecture(machine: str, sourced: bool) -> Check:
    """x86_64 for the ROS 2 wheels; whatever a sourced ROS 2 Jazzy runs on where there is one."""
    if sourced or machine == "x86_64":
        return passed(machine)
    reason = "the wheels of ROS 2 exist for x86_64 only; apt has it for arm64 on Ubuntu 24.04, and the course uses that"
    return fail(machine, reason, APT_JAZZY)


def available_memory(meminfo: Path = Path("/proc/meminfo"), cgroup: Path = Path("/sys/fs/cgroup")) -> tuple[int, int]:
    """Available and total memory in MB, within the limit of a container if there is one."""
    system = _fields(meminfo)
    total, available = system["MemTotal:"] // 1000, system["MemAvailable:"] // 1000  # from kB
    try:
        limit, used = (int((cgroup / name).read_text()) for name in ("memory.max", "memory.current"))
        reclaimable = _fields(cgroup / "memory.stat")["inactive_file"]
    except (OSError, ValueError, KeyError):  # no container, or no limit
        return available, total
    return min(available, (limit - used + reclaimable) // 1_000_000), min(total, limit // 1_000_000)


def _fields(path: Path) -> dict[str, int]:
    """Lines such as "MemTotal: 1000 kB" or "inactive_file 4096" as numbers."""
    words = (line.split() for line in path.read_text().splitlines())
    return {fields[0]: int(fields[1]) for fields in words if len(fields) > 1}


def memory(available: int, total: int) -> Check:
    """Enough of it free for JupyterLab, the kernels and a browser; both in MB."""
    detail = f"{available} of {total} MB available"
    if available >= NEEDED_MEMORY:
        return passed(detail)
    if total < NEEDED_MEMORY // 2:
        reason = "JupyterLab with one notebook takes about 500 MB, so this machine would kill the kernel"
        cure = "give the machine or the container more memory, for example: docker run --memory=2g"
        return fail(detail, reason, cure)
    reason = f"JupyterLab, two kernels and a browser take up to {NEEDED_MEMORY} MB; with less all gets slow"
    return warn(detail, reason, "close other programs; this shows the largest: ps aux --sort=-rss | head")


def disk(folder: Path, ready: bool) -> Check:
    """Room for the environment, or once it is there for what the chapters write; and the right to write."""
    if is_of_windows(folder):
        reason = "from WSL each file there takes ten times as long, and links and permissions do not work as in Linux"
        cure = f"work in Linux's own folders: cp -r '{folder}' ~/course && cd ~/course"
        return warn(f"{folder} is on a disk of Windows", reason, cure)
    free = shutil.disk_usage(folder).free // 1_000_000
    return disk_space(folder, free, os.access(folder, os.W_OK), ready)


def is_of_windows(folder: Path) -> bool:
    """Return True if it is on a disk of Windows, seen from WSL."""
    return is_wsl(platform.release()) and re.match(r"/mnt/[a-z]/", f"{folder}/") is not None


def disk_space(folder: Path, free: int, writable: bool, ready: bool) -> Check:
    """The same from figures: `free` in MB."""
    if not writable and not ready:
        reason = "set-up makes the environment in the course's own folder"
        cure = f"work in a copy of your own: cp -r '{folder}' ~/course && cd ~/course"
        return fail(f"{folder} cannot be written", reason, cure)
    detail = f"{free} MB free for the course"
    cure = "free some space; this shows where it went: du -xh ~ | sort -h | tail"
    if not ready and free < NEEDED_DISK:
        return fail(detail, f"set-up needs {NEEDED_DISK} MB", cure)
    if free < SPARE_DISK:
        reason = "recordings, bags and workspaces need room; a full disk makes saving a notebook fail"
        return warn(detail, reason, cure)
    return passed(detail)
