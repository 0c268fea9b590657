"""The names that notebooks import from course_kit."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import course_kit


@pytest.mark.parametrize("first", sorted(course_kit.EXPORTS))
def test_every_name_is_what_it_says_whatever_was_imported_before(first):
    names = ", ".join([first, *course_kit.EXPORTS])
    code = f"from course_kit import {names}; print([n for n in course_kit_names if not callable(globals()[n])])"
    program = f"course_kit_names = {sorted(course_kit.EXPORTS)!r}\n{code}"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert (done.stdout, done.stderr) == ("[]\n", "")


def test_no_module_hides_the_name_that_it_gives():
    modules = {path.stem for path in Path(course_kit.__file__).parent.iterdir()}
    assert modules & course_kit.EXPORTS.keys() == set()


def test_importing_the_package_starts_nothing_and_is_quick():
    code = "import sys, course_kit; print([m for m in ('rclpy', 'matplotlib', 'IPython') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stdout == "[]\n"
