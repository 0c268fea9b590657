"""The C and C++ compiler: the machine's, else the one that comes as a wheel (ziglang), where ROS 2 comes as wheels too.

Runs before anything is installed, so it uses the standard library alone.
"""

from __future__ import annotations

import importlib.util
import os
import platform
import shlex
import shutil
import sys
import sysconfig
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

WHEEL = "ziglang"
OLDEST_GLIBC = (2, 28)  # the ROS 2 wheels are manylinux_2_28
COMPILERS, TOOLS = ("cc", "c++"), ("ar", "ranlib")
# What is compiled runs wherever the wheels of ROS 2 run, and behaves as compiled by g++: without the checks for
# undefined behaviour that zig adds where nothing is optimised.
OPTIONS = (
    "-target", f"{platform.machine()}-linux-gnu.{'.'.join(map(str, OLDEST_GLIBC))}", "-mcpu=baseline",
    "-fno-sanitize=undefined",
)  # fmt: skip
HEADERS = "include"


class CompileError(SystemExit):
    """Something that compiling needs is missing; the text says what to install."""


@dataclass(frozen=True)
class Compiler:
    """The commands that compile C and C++."""

    c: list[str]
    cxx: list[str]


def of_the_machine(environ: Mapping[str, str]) -> str | None:
    """$CXX, or the path of c++; None if there is neither."""
    return environ.get("CXX") or shutil.which("c++", path=environ.get("PATH"))


def find(folder: Path) -> Compiler:
    """$CC and $CXX, else cc and c++, else the wheel's, which finds in `folder` what it needs of this Python."""
    if not Path(sysconfig.get_path("include"), "Python.h").exists():
        raise CompileError(
            f"Python.h of {sys.executable} is missing, and compiling the ROS interfaces needs it. "
            f"Install it: sudo apt-get install python3.{sys.version_info.minor}-dev"
        )
    if (os.environ.get("CC") or shutil.which("cc")) and of_the_machine(os.environ):
        return Compiler(shlex.split(os.environ.get("CC") or "cc"), shlex.split(os.environ.get("CXX") or "c++"))
    wheel = importlib.util.find_spec(WHEEL)
    if wheel is None or wheel.origin is None:
        raise CompileError("No C++ compiler. Install one: sudo apt-get install -y g++, or set CC and CXX.")
    add_python_headers(folder)
    zig = str(Path(wheel.origin).with_name("zig"))
    return Compiler(*([zig, name, *OPTIONS, f"-I{folder / HEADERS}"] for name in COMPILERS))


def add_python_headers(folder: Path) -> None:
    """Lead a compiler that has a C library of its own to pyconfig.h.

    Debian's pyconfig.h includes <x86_64-linux-gnu/python3.11/pyconfig.h>, as seen from /usr/include. With that folder
    the wheel's compiler would see the headers of the machine's C library beside its own.
    """
    include, multiarch = Path(sysconfig.get_path("include")), sysconfig.get_config_var("MULTIARCH") or ""
    part = Path(multiarch, include.name, "pyconfig.h")
    original, header = include.parent / part, folder / HEADERS / part
    if multiarch and original.exists():
        header.parent.mkdir(parents=True, exist_ok=True)
        header.write_text(f'#include "{original}"\n')


def write_tools(folder: Path, to_prefix: str) -> None:
    """The wheel's tools as commands for CMake; `to_prefix` leads from where they will be to the environment."""
    add_python_headers(folder)
    zig = os.path.join(to_prefix, os.path.relpath(sysconfig.get_path("platlib"), sys.prefix), WHEEL, "zig")
    for name in (*COMPILERS, *TOOLS):
        options = f' {shlex.join(OPTIONS)} "-I$here/{HEADERS}"' if name in COMPILERS else ""
        command = folder / name
        command.write_text(f'#!/bin/sh\nhere=${{0%/*}}\nexec "$here/{zig}" {name}{options} "$@"\n')
        command.chmod(0o755)
