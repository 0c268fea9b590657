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
RUNTIME_HEADER = "with_libstdcxx.hpp"
# Libraries of ROS packages use the C++ library that ROS 2's own are built with, which these load. zig would compile its
# own one first, for more than a minute. What its headers leave to it, and libstdc++ does not have, is compiled with
# each file instead: the members of string, two constructors.
RUNTIME = """\
#define _LIBCPP___STRING_EXTERN_TEMPLATE_LISTS_H
#define _LIBCPP_STRING_V1_EXTERN_TEMPLATE_LIST(...)
#include <new>
inline std::bad_alloc::bad_alloc() noexcept {}
inline std::bad_array_new_length::bad_array_new_length() noexcept {}
"""
WITHOUT_OWN_RUNTIME = "-nostdlib++"


class CompileError(SystemExit):
    """Something that compiling needs is missing; the text says what to install."""


@dataclass(frozen=True)
class Compiler:
    """The commands that compile C and C++."""

    c: list[str]
    cxx: list[str]
    link: list[str]  # shared libraries of ROS packages


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
        cxx = shlex.split(os.environ.get("CXX") or "c++")
        return Compiler(shlex.split(os.environ.get("CC") or "cc"), cxx, [*cxx, "-shared"])
    wheel = importlib.util.find_spec(WHEEL)
    if wheel is None or wheel.origin is None:
        raise CompileError("No C++ compiler. Install one: sudo apt-get install -y g++, or set CC and CXX.")
    add_headers(folder)
    zig, headers = str(Path(wheel.origin).with_name("zig")), folder / HEADERS
    c, cxx = ([zig, name, *OPTIONS, f"-I{headers}"] for name in COMPILERS)
    return Compiler(c, [*cxx, "-include", str(headers / RUNTIME_HEADER)], [*cxx, "-shared", WITHOUT_OWN_RUNTIME])


def add_headers(folder: Path) -> None:
    """Write the headers that a compiler with C and C++ libraries of its own needs here: RUNTIME, and for Python.h.

    Debian's pyconfig.h includes <x86_64-linux-gnu/python3.11/pyconfig.h>, as seen from /usr/include. With that folder
    the wheel's compiler would see the headers of the machine's C library beside its own.
    """
    (folder / HEADERS).mkdir(parents=True, exist_ok=True)
    (folder / HEADERS / RUNTIME_HEADER).write_text(RUNTIME)
    include, multiarch = Path(sysconfig.get_path("include")), sysconfig.get_config_var("MULTIARCH") or ""
    part = Path(multiarch, include.name, "pyconfig.h")
    original, header = include.parent / part, folder / HEADERS / part
    if multiarch and original.exists():
        header.parent.mkdir(parents=True, exist_ok=True)
        header.write_text(f'#include "{original}"\n')


def write_tools(folder: Path, to_prefix: str) -> None:
    """The wheel's tools as commands for CMake; `to_prefix` leads from where they will be to the environment."""
    add_headers(folder)
    zig = os.path.join(to_prefix, os.path.relpath(sysconfig.get_path("platlib"), sys.prefix), WHEEL, "zig")
    options = f'{shlex.join(OPTIONS)} "-I$here/{HEADERS}"'
    commands = {name: f'exec "$zig" {name} "$@"' for name in TOOLS}
    commands["cc"] = f'exec "$zig" cc {options} "$@"'
    header = f'-include "$here/{HEADERS}/{RUNTIME_HEADER}"'
    # A program that uses nothing of the C++ library, such as CMake's first trials, does not wait for it to be compiled.
    trial = f'*) "$zig" c++ {options} {WITHOUT_OWN_RUNTIME} "$@" 2> /dev/null && exit ;;'
    commands["c++"] = (
        f'case " $* " in *" -c "* | *" -E "* | *" -S "* | *" -shared "*) ;; {trial} esac\n'
        f'exec "$zig" c++ {options} {header} "$@"'
    )
    for name, command in commands.items():
        (folder / name).write_text(f"#!/bin/sh\nhere=${{0%/*}}\nzig=$here/{zig}\n{command}\n")
        (folder / name).chmod(0o755)
