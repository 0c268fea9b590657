"""The levels of set-up: what each installs, what the stamp says, and going up, with the packages of a small index."""

from __future__ import annotations

import ast
import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator, Sequence
from functools import partial
from hashlib import sha256
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from importlib.metadata import PackageNotFoundError, distribution, metadata
from pathlib import Path

import packaging
import pytest
from packaging.requirements import Requirement

from course_kit.setup.environment import additions, levels, pins, stamp
from course_kit.setup.environment.interpreter import applicable
from course_kit.setup.environment.levels import GRADING, STUDENT, TEST
from tests.course_copy import BASE_PYTHON, ROOT, SET_UP, UV, CourseCopy, fresh_environ, needs_root, needs_uv
from tests.http_server import serving

THIS = sys.version_info[:2]


# ---- what belongs to which


def test_each_level_has_all_of_those_before_it():
    student, grading, test = map(pins.packages, levels.LEVELS)
    assert student < grading < test
    assert len(re.findall(pins.REQUIREMENT, pins.LOCK.read_text(), re.MULTILINE)) == len(
        pins.requirements(with_ros=True, with_compiler=True, level=TEST)
    )


def test_each_pin_of_a_group_belongs_to_the_level_of_the_group():
    project = (ROOT / "pyproject.toml").read_text()
    for level, groups in levels.LEVELS.items():
        for group in groups:
            (block,) = re.findall(rf"^{group} = \[\n(.*?)^\]", project, re.MULTILINE | re.DOTALL)
            names = set(re.findall(r'^ +"([\w-]+)', block, re.MULTILINE))
            assert names and names <= pins.packages(level)
            if level != STUDENT:
                below = pins.packages(levels.up_to(level)[-2])
                assert names & below <= {"pytest"}  # which colcon brings


@pytest.mark.parametrize("level", [STUDENT, GRADING])
def test_what_is_installed_for_a_level_depends_on_nothing_above_it(level):
    names = pins.packages(level)
    for name, _ in applicable(pins.requirements(with_ros=True, level=level)):
        try:
            needed = map(Requirement, distribution(name).requires or ())
        except PackageNotFoundError:  # beside a ROS 2 from apt
            continue
        for one in needed:
            if one.marker is None or one.marker.evaluate({"extra": ""}):
                assert re.sub("[-_.]+", "-", one.name).lower() in names, f"{name} needs {one}"


def test_pip_gets_the_higher_levels_as_extras():
    about = metadata("ros2-notebook-course")
    assert about.get_all("Provides-Extra") == [GRADING, TEST]
    needed = [one for one in about.get_all("Requires-Dist") or () if "extra ==" in one]
    assert any(one.startswith("nbval==") and "grading" in one for one in needed)
    assert not any(one.startswith("mypy==") and "grading" in one for one in needed)


# ---- what a student's environment can do without them


@pytest.fixture(scope="module")
def modules() -> set[str]:
    """The modules at the top of what only the higher levels have."""
    paths = [path for name, _ in applicable(pins.added(TEST)) for path in distribution(name).files or ()]
    tops = {path.parts[0] if len(path.parts) > 1 else path.stem for path in paths if path.suffix in (".py", ".so")}
    return {top.partition(".")[0] for top in tops if top != ".."}


def imported(source: str) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {one.name.partition(".")[0] for one in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found.add(str(node.module).partition(".")[0])
    return found


def test_nothing_but_the_grader_imports_them(modules):
    assert {"tqdm", "distributed", "nbval", "mypy", "playwright"} <= modules
    own = {path: path.read_text() for path in (ROOT / "course_kit").rglob("*.py")}
    found = {str(path.relative_to(ROOT / "course_kit")): imported(text) & modules for path, text in own.items()}
    assert {path: names for path, names in found.items() if names} == {
        "classroom/run/cluster.py": {"distributed"},
        "classroom/command.py": {"tqdm"},
    }
    named = re.compile(rf"^\s*(?:import|from) ({'|'.join(map(re.escape, modules))})\b", re.MULTILINE)
    for notebook in (ROOT / "notebooks").glob("*.ipynb"):
        for cell in json.loads(notebook.read_text())["cells"]:
            assert cell["cell_type"] != "code" or not named.search("".join(cell["source"]))


def test_the_grader_begins_without_them(modules):
    program = (
        "import sys\n"
        "class Hidden:\n"
        "    def find_spec(self, name, *_):\n"
        f"        if name.partition('.')[0] in {modules!r}: raise ModuleNotFoundError(name, name=name)\n"
        "sys.meta_path.insert(0, Hidden())\n"
        "from course_kit.classroom.course_command import main\n"
        "main(['grade', '--help'])\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
    assert "--scheduler" in done.stdout


# ---- the stamp


@pytest.fixture
def course(tmp_path) -> CourseCopy:
    return CourseCopy(tmp_path, parts=SET_UP)


def finish(course: CourseCopy, level: str) -> None:
    (course.root / ".venv").mkdir(exist_ok=True)
    (course.root / ".venv" / stamp.NAME).write_text(f"{stamp.digest(course.root, {}, THIS)} {level}\n")


@pytest.mark.parametrize("there", levels.LEVELS)
def test_a_level_satisfies_those_below_it(course, there):
    finish(course, there)
    states = {level: stamp.state(course.root, {}, THIS, level) for level in levels.LEVELS}
    lower = levels.up_to(there)
    assert states == {level: stamp.READY if level in lower else stamp.BELOW for level in levels.LEVELS}


def test_a_set_up_anew_takes_no_level_away(course):
    finish(course, TEST)
    with open(course.root / "pyproject.toml", "a") as file:
        file.write("# changed\n")
    assert stamp.state(course.root, {}, THIS, STUDENT) == stamp.OUTDATED
    assert levels.higher(stamp.level_of(course.root / ".venv"), STUDENT) == TEST


@pytest.mark.parametrize("text", ["", "0123abcd", "0123abcd doctor"])
def test_a_stamp_without_a_level_that_there_is_counts_as_the_lowest(tmp_path, text):
    (tmp_path / stamp.NAME).write_text(text)
    assert stamp.level_of(tmp_path) == STUDENT


def test_going_up_downloads_less_than_a_set_up():
    anew = [levels.download(level) for level in levels.LEVELS]
    assert anew == sorted(anew)
    assert levels.download(TEST, there=STUDENT) == anew[2] - anew[0]


# ---- going up


def wheel(folder: Path, name: str) -> str:
    """Make the wheel of a small package; return its line in a lock, without what needs it."""
    path = folder / name / f"{name}-1-py3-none-any.whl"
    path.parent.mkdir(parents=True)
    files = {
        f"{name}.py": "",
        f"{name}-1.dist-info/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: 1\n",
        f"{name}-1.dist-info/WHEEL": "Wheel-Version: 1.0\nGenerator: tests\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    record = "".join(f"{file},,\n" for file in (*files, f"{name}-1.dist-info/RECORD"))
    with zipfile.ZipFile(path, "w") as archive:
        for file, text in {**files, f"{name}-1.dist-info/RECORD": record}.items():
            archive.writestr(file, text)
    return f"{name}==1 \\\n    --hash=sha256:{sha256(path.read_bytes()).hexdigest()}\n"


class Index(SimpleHTTPRequestHandler):
    """The wheels in a folder, as a package index has them."""

    def do_GET(self) -> None:
        self.server.asked.append(self.path)  # type: ignore[attr-defined]
        super().do_GET()

    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def index(tmp_path) -> Iterator[ThreadingHTTPServer]:
    with serving(partial(Index, directory=str(tmp_path / "index"))) as server:
        yield server


@pytest.fixture
def environ(index, tmp_path) -> dict[str, str]:
    """A terminal whose packages come from that index alone."""
    quick = {"UV_HTTP_RETRIES": "0", "UV_CACHE_DIR": str(tmp_path / "cache"), "PIP_CONFIG_FILE": os.devnull}
    return fresh_environ(**quick, UV_DEFAULT_INDEX=f"http://127.0.0.1:{index.server_port}/")


@pytest.fixture
def students(course, environ, index, tmp_path) -> CourseCopy:
    """A course of two small packages, `base` for students and `marks` for graders, set up for students."""
    needs = {"base": "notebook", "marks": "grading"}
    lock = [
        f"{wheel(tmp_path / 'index', name)}    # via ros2-notebook-course (pyproject.toml:{group})\n"
        for name, group in needs.items()
    ]
    (course.root / "course_kit/setup/environment/requirements.lock").write_text("".join(lock))
    installer = course.root / "build/uv-0.13.8/bin"
    installer.mkdir(parents=True)
    (installer / "uv").symlink_to(str(UV))
    python = course.root / ".venv/bin/python"
    for command in (
        ["venv", "-q", "--python", BASE_PYTHON, ".venv"],
        ["pip", "install", "-q", "--python", python, "base"],
    ):
        subprocess.run([str(UV), *command], cwd=course.root, env=environ, check=True, timeout=60)
    there = Path(str(packaging.__file__)).parent  # which JupyterLab brings
    shutil.copytree(there, next(course.root.glob(".venv/lib/python3.*/site-packages")) / "packaging")
    finish(course, STUDENT)
    index.asked.clear()  # type: ignore[attr-defined]
    return course


PROGRAM = """
from course_kit.setup.environment import additions
try:
    additions.add("grading", "course grade .")
except additions.NotAdded as error:
    raise SystemExit(f"course: {error}" if str(error) else 2)
import marks
"""


def grade(course: CourseCopy, environ: dict[str, str], view: str = "") -> subprocess.Popen[str]:
    """Start what `course grade` does first; `view` is a shell command that mounts what only this one shall see."""
    command: Sequence[str] = [str(course.root / ".venv/bin/python"), "-c", PROGRAM]
    if view:
        command = ["unshare", "--mount", "sh", "-c", f'{view} && cd . && exec "$@"', "sh", *command]
    return subprocess.Popen(command, cwd=course.root, env=environ, text=True, stderr=subprocess.PIPE)


def refused(course: CourseCopy, environ: dict[str, str], view: str = "") -> list[str]:
    """What it says when it fails."""
    process = grade(course, environ, view)
    _, said = process.communicate(timeout=60)
    assert process.returncode
    return said.splitlines()


def level_of(course: CourseCopy) -> str:
    return stamp.level_of(course.root / ".venv")


@needs_uv
def test_the_first_of_two_graders_adds_what_is_missing_and_nothing_else(students, environ, index):
    both = [grade(students, environ) for _ in range(2)]
    said = "".join(process.communicate(timeout=60)[1] for process in both)
    assert [process.returncode for process in both] == [0, 0], said
    assert said.count("Adding to .venv what `course grade` needs, which downloads 4 MB") == 1
    assert {path for path in index.asked if path.endswith(".whl")} == {"/marks/marks-1-py3-none-any.whl"}
    assert level_of(students) == GRADING
    third = grade(students, environ)
    assert third.communicate(timeout=60)[1] == ""


@needs_uv
def test_without_network_a_grader_says_it_in_a_line_and_students_lose_nothing(students, environ):
    environ["UV_DEFAULT_INDEX"] = "http://127.0.0.1:9/"  # where nobody answers
    begun, said = refused(students, environ)
    assert begun.startswith("Adding to .venv")
    assert said.startswith("environment-check: What `course grade` needs could not be installed. The network was lost")
    assert "then: course grade ." in said and f"Log: {students.root}/build/set-up.log" in said
    assert level_of(students) == STUDENT
    assert stamp.state(students.root, {}, THIS, STUDENT) == stamp.READY


@needs_uv
def test_without_network_lab_says_what_to_repeat(students, environ):
    environ["UV_DEFAULT_INDEX"] = "http://127.0.0.1:9/"
    done = students.run("lab", "--with-grading", environ=environ)
    assert done.returncode == 1
    begun, what, *parts = done.stderr.splitlines()
    assert begun.startswith("Adding to .venv what `course grade` needs")
    assert what == "environment-check: What `course grade` needs could not be installed."
    assert [part.partition(":")[0] for part in parts] == ["said", "why", "cure", "log"]
    assert "then: ./environment-check.sh lab --with-grading." in parts[2]


@needs_uv
@needs_root
def test_to_an_environment_that_cannot_be_written_nothing_is_added(students, environ):
    here = f"'{students.root}'"
    (said,) = refused(students, environ, view=f"mount --bind {here} {here} && mount -o remount,ro,bind {here}")
    assert said.startswith("course: needed here, but not installed: marks. ")
    assert f"{students.root}/.venv cannot be written" in said
    assert said.endswith("./environment-check.sh lab --with-grading")


@needs_uv
def test_an_environment_of_ones_own_is_left_as_it_is(students, environ):
    (students.root / ".venv" / stamp.NAME).unlink()
    next(students.root.glob(".venv/lib/python3.*/site-packages")).joinpath("ros2_notebook_course-0.dist-info").mkdir()
    (said,) = refused(students, environ)
    assert "has not made it" in said and said.endswith("/.venv/bin/python -m pip install -e '.[grading]'")
    done = students.run("lab", "--with-grading", environ=environ)
    assert done.returncode == 1
    assert done.stderr.splitlines()[1].endswith(said.removeprefix("course: "))


@needs_uv
def test_an_environment_of_another_version_is_not_added_to(students, environ):
    with open(students.root / "pyproject.toml", "a") as file:
        file.write("# changed\n")
    (said,) = refused(students, environ)
    assert "set up for another version of the course" in said
    assert said.endswith(additions.WITH_GRADING)


@needs_uv
def test_what_somebody_has_removed_is_told(students, environ):
    finish(students, GRADING)
    (said,) = refused(students, environ)
    assert "Somebody has removed that" in said and said.endswith("rm -rf .venv && ./environment-check.sh lab")
