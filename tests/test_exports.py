"""The names that notebooks import from course_kit."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import course_kit
from course_kit.exercises.catalogue import CHAPTERS

NAMES = sorted(course_kit.EXPORTS)


@pytest.mark.parametrize("names", [NAMES, NAMES[::-1]], ids=["forwards", "backwards"])
def test_every_name_is_what_it_says_whatever_was_imported_before(names):
    lines = [f"from course_kit import {name}" for name in names]
    lines += [f"from course_kit import {name}\nprint({name!r}) if {name} is None else None" for name in names]
    done = subprocess.run([sys.executable, "-c", "\n".join(lines)], capture_output=True, text=True, timeout=60)
    assert (done.stdout, done.stderr) == ("", "")


def test_a_students_process_loads_nothing_of_the_classroom_and_of_the_checkers_half():
    """Also after a check, a solution, the student's progress, and a robot with a fault."""
    code = (
        "import sys, course_kit\nfrom course_kit import *\nfrom course_kit.exercises.in_notebook import progress\n"
        "check('topics-1'); solution('topics-1'); print(progress.Progress())\nfaults.start('qos')\n"
        "print(sorted(name for name in sys.modules if name.startswith('course_kit.')), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    loaded = ast.literal_eval(done.stderr.splitlines()[-1])
    assert "topics-1" in done.stdout and len(loaded) > 200
    ours = ("course_kit.classroom", "course_kit.exercises.checker", *map("course_kit.exercises.{}".format, CHAPTERS))
    assert [name for name in loaded if name.startswith(ours)] == []


def test_no_module_hides_the_name_that_it_gives():
    modules = {path.stem for path in Path(course_kit.__file__).parent.iterdir()}
    assert modules & course_kit.EXPORTS.keys() == set()


def test_importing_the_package_starts_nothing_and_is_quick():
    code = "import sys, course_kit; print([m for m in ('rclpy', 'matplotlib', 'IPython') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stdout == "[]\n"


def test_importing_a_name_changes_nothing_in_rclpy():
    code = (
        "import rclpy, rclpy.executors, rclpy.action, rclpy.client, course_kit\n"
        "parts = (rclpy, rclpy.executors.Executor, rclpy.client.Client, rclpy.action.ActionClient)\n"
        "before = [dict(vars(part)) for part in parts]\n"
        "names = [getattr(course_kit, name) for name in course_kit.EXPORTS]\n"
        "for part, held in zip(parts, before):\n"
        "    print([name for name, value in vars(part).items() if name in held and held[name] is not value])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert (done.stdout, done.stderr) == ("[]\n[]\n[]\n[]\n", "")


@pytest.mark.parametrize("line", ["node list", "topic list", "action list", "service list"])
def test_a_command_that_only_looks_loads_no_numpy(line):
    """Which takes longer than all else that it does."""
    code = (
        "import sys\nfrom course_kit.cli.ros2 import command\n"
        f"command.run({line.split()!r})\nprint('numpy' in sys.modules, file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stderr.splitlines()[-1] == "False"
