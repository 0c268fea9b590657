"""The students' edition: the same to the byte from every clone, whole, with or without solutions, and fit for use."""

from __future__ import annotations

import json
import os
import re
import shutil
import stat
import subprocess
import sys
import zipfile
from hashlib import sha256
from pathlib import Path

import nbformat
import pytest

from course_kit.classroom import course_command, release
from course_kit.exercises import catalogue
from course_kit.exercises.notebooks import reference
from tests.course_copy import BASE_PYTHON, ROOT, fresh_environ
from tests.exercises.chapter import solved

EXERCISES = [each.name for each in catalogue.EXERCISES]
TOPICS = "notebooks/03_topics.ipynb"


def git(folder: Path, *words: str) -> str:
    environ = {name: value for name, value in os.environ.items() if not name.startswith("GIT_")}
    me = ("-c", "user.name=me", "-c", "user.email=me@example.org")
    return subprocess.run(
        ["git", *me, *words], cwd=folder, env=environ, check=True, capture_output=True, text=True, timeout=60
    ).stdout


def clone(folder: Path, mask: int = 0o022, reverse: bool = False) -> Path:
    """The course as it lies here, with what is new and not committed, committed in a repository of its own."""
    paths = set(git(ROOT, "ls-files", "-z", "--cached", "--others", "--exclude-standard").split("\0")[:-1])
    before = os.umask(mask)
    try:
        for path in sorted(paths, reverse=reverse):
            source, target = ROOT / path, folder / path
            target.parent.mkdir(parents=True, exist_ok=True)
            if source.is_symlink():
                target.symlink_to(os.readlink(source))
            elif source.exists():
                target.write_bytes(source.read_bytes())
                target.chmod((0o777 if os.access(source, os.X_OK) else 0o666) & ~mask)
        git(folder, "init", "--quiet")
        commit(folder)
    finally:
        os.umask(before)
    return folder


def commit(folder: Path) -> None:
    git(folder, "add", "--all")
    git(folder, "commit", "--quiet", "--message", "all")


@pytest.fixture(scope="module")
def course(tmp_path_factory) -> Path:
    return clone(tmp_path_factory.mktemp("clone") / "course")


@pytest.fixture
def own(course, tmp_path) -> Path:
    """A clone that a test may change."""
    return Path(shutil.copytree(course, tmp_path / "own", symlinks=True))


@pytest.fixture(scope="module")
def edition(course, tmp_path_factory) -> Path:
    return release.write(tmp_path_factory.mktemp("release") / "course.zip", course)


@pytest.fixture(scope="module")
def edition_without(course, tmp_path_factory) -> Path:
    """The one without solutions."""
    return release.write(tmp_path_factory.mktemp("release") / "course.zip", course, with_solutions=False)


@pytest.fixture(scope="module")
def contents(edition) -> dict[str, bytes]:
    return contents_of(edition)


@pytest.fixture(scope="module")
def contents_without(edition_without) -> dict[str, bytes]:
    return contents_of(edition_without)


def contents_of(edition: Path) -> dict[str, bytes]:
    """What is in the top folder, by path."""
    with zipfile.ZipFile(edition) as archive:
        return {name.removeprefix(f"{release.TOP}/"): archive.read(name) for name in archive.namelist()}


@pytest.fixture(scope="module")
def unpacked(edition, tmp_path_factory) -> Path:
    return unpack(edition, tmp_path_factory.mktemp("student"))


def unpack(edition: Path, folder: Path) -> Path:
    with zipfile.ZipFile(edition) as archive:
        for entry in archive.infolist():  # with the modes, which Python's own extraction forgets
            Path(archive.extract(entry, folder)).chmod(entry.external_attr >> 16 & 0o777)
    return folder / release.TOP


@pytest.fixture(scope="module")
def manifest(contents) -> dict:
    return json.loads(contents["manifest.json"])


def rewrite(root: Path, change) -> None:
    """Change the notebook of the topics chapter as JupyterLab would."""
    notebook = nbformat.read(root / TOPICS, as_version=4)
    change({cell.id: cell for cell in notebook.cells})
    nbformat.write(notebook, root / TOPICS)


# ---- The same to the byte


def test_two_clones_give_the_same_bytes(edition, edition_without, tmp_path):
    other = clone(tmp_path / "another place" / "kurs", mask=0o077, reverse=True)
    for number, path in enumerate(sorted(other.rglob("*"), reverse=True)):
        os.utime(path, (number * 86_400, number * 86_400), follow_symlinks=False)
    for path in ("build/x", ".venv/bin/python", "notebooks/ros2_ws/src/x.py", "notebooks/.ipynb_checkpoints/x.ipynb"):
        (other / path).parent.mkdir(parents=True)
        (other / path).write_text("left over")
    (other / "notes.txt").write_text("left over")
    before = os.umask(0o077)
    try:
        path = release.write(tmp_path / "course.zip", other)
    finally:
        os.umask(before)
    assert path.read_bytes() == edition.read_bytes()
    path = release.write(tmp_path / "without.zip", other, with_solutions=False)
    assert path.read_bytes() == edition_without.read_bytes()


def test_nothing_in_it_depends_on_time_machine_or_zlib(edition):
    with zipfile.ZipFile(edition) as archive:
        entries = archive.infolist()
    names = [entry.filename for entry in entries]
    assert names == sorted(names)
    assert len(names) == len(set(names))
    assert {entry.date_time for entry in entries} == {(1980, 1, 1, 0, 0, 0)}
    assert {entry.compress_type for entry in entries} == {zipfile.ZIP_STORED}
    assert {entry.external_attr >> 16 for entry in entries} == {stat.S_IFREG | 0o644, stat.S_IFREG | 0o755}


def test_the_clone_stays_as_it_is(own, tmp_path):
    before = {path: path.lstat().st_mtime_ns for path in own.rglob("*")}
    release.write(tmp_path / "course.zip", own)
    assert {path: path.lstat().st_mtime_ns for path in own.rglob("*")} == before


# ---- What students get


def test_students_get_all_but_what_is_the_instructors_and_the_maintainers(course, contents):
    tracked = git(course, "ls-files", "-z").split("\0")[:-1]
    left = {path for path in tracked if path not in contents}
    assert {path.split("/")[0] for path in left} == {".ci", "CONTRIBUTING.md", "docs", "tests"}
    copies = {f"course_kit/exercises/notebooks/edition/{chapter.file}" for chapter in reference.chapters()}
    assert set(contents) - set(tracked) == {"manifest.json", *copies}
    assert ".gitignore" in contents
    changed = {path for path in set(contents) & set(tracked) if contents[path] != (course / path).read_bytes()}
    assert changed == {"README.md"}


def test_the_solutions_are_in_it_unless_it_is_made_without(contents, contents_without):
    solutions = {f"course_kit/exercises/{name[:-2]}/solutions/{name}.md" for name in EXERCISES}
    assert set(contents) - set(contents_without) == solutions
    changed = {path for path in contents_without if contents[path] != contents_without[path]}
    assert changed == {"README.md", "manifest.json"}
    of_each = [json.loads(each["manifest.json"]) for each in (contents, contents_without)]
    assert [each["solutions"] for each in of_each] == [True, False]
    assert set(of_each[1]["files"]) == set(contents_without) - {"manifest.json"}


def test_the_command_makes_it_without(course, edition_without, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(release.write, "__defaults__", (course, True))
    assert course_command.main(["release", str(tmp_path / "course.zip"), "--without-solutions"]) == 0
    assert capsys.readouterr().out.endswith(", with manifest.json, without solutions\n")
    assert (tmp_path / "course.zip").read_bytes() == edition_without.read_bytes()


def test_without_them_solution_says_so(edition_without, tmp_path):
    folder = unpack(edition_without, tmp_path)
    code = "import course_kit; print(course_kit.__file__); course_kit.solution('topics-2')"
    said = run(
        folder, sys.executable, "-c", code, PYTHONPATH=str(folder), XDG_STATE_HOME=str(tmp_path)
    ).stdout.splitlines()
    assert said == [
        str(folder / "course_kit/__init__.py"),
        "solution: this edition of the course has no solutions. Your instructor has them.",
    ]


@pytest.mark.parametrize("kind", ["with", "without"])
def test_no_solution_is_elsewhere_in_it(contents, contents_without, kind):
    there = contents if kind == "with" else contents_without
    elsewhere = {path: content for path, content in there.items() if not path.startswith(release.SOLUTIONS)}
    text = "\n".join(content.decode(errors="replace") for content in elsewhere.values())

    def is_there(line: str) -> bool:
        return line in text or json.dumps(line)[1:-1] in text

    references = {name: "\n".join(solved(name).cells) for name in EXERCISES}
    told = [name for name, source in references.items() if all(map(is_there, map(str.strip, source.splitlines())))]
    assert told == []


@pytest.mark.parametrize("kind", ["with", "without"])
def test_the_readme_says_only_what_is_true_there(course, contents, contents_without, kind):
    readme = (contents if kind == "with" else contents_without)["README.md"].decode()
    assert ('`solution("topics-2")`' in readme) == (kind == "with")
    assert "\n\n\n" not in readme
    for untrue in (
        "<!--",
        "-->",
        "environment-check.sh test",
        "tests/",
        "CONTRIBUTING",
        "Instructors",
        "a clone",
        "## Folders",
    ):
        assert untrue not in readme
    for kept in ("./environment-check.sh lab", "**Without network**", "\n\nLicense: Apache-2.0."):
        assert kept in readme
    linked = re.findall(r"\]\((?!https:)([^)]+)\)", readme)
    assert len(linked) > 6
    assert set(linked) <= set(contents_without)
    assert "environment-check.sh test" in (course / "README.md").read_text()


def test_uncommitted_changes_are_released_and_told(own, tmp_path, caplog):
    rewrite(own, lambda cells: cells["topics-ex1"].update(source=cells["topics-ex1"].source + "\n\nHurry up."))
    (own / "tests/conftest.py").write_text("")
    (own / "LICENSE").unlink()
    (own / "notes.txt").write_text("untracked")
    with zipfile.ZipFile(release.write(tmp_path / "course.zip", own)) as archive:
        assert archive.read(f"{release.TOP}/{TOPICS}") == (own / TOPICS).read_bytes()
        assert f"{release.TOP}/LICENSE" not in archive.namelist()
    assert caplog.messages == [
        f"released with changes that are not committed: LICENSE, {TOPICS}",
        "not released, as git does not track it: notes.txt",
    ]


def test_what_the_instructors_machine_has_shown_about_itself_is_not_released(own, tmp_path):
    empty = {"0_start.ipynb": ["start-progress"], "01_setup_checks.ipynb": ["setup-report"]}
    for name, ids in empty.items():
        path = own / "notebooks" / name
        notebook = nbformat.read(path, as_version=4)
        for cell in notebook.cells:
            if cell.id in ids:
                cell.execution_count, cell.outputs = 7, [nbformat.v4.new_output("stream", text="the instructor's")]
        nbformat.write(notebook, path)
    files = contents_of(release.write(tmp_path / "course.zip", own))
    for name in empty:
        assert files[f"notebooks/{name}"] == (ROOT / "notebooks" / name).read_bytes()


def test_of_a_clone_without_changes_nothing_is_told(course, tmp_path, caplog):
    release.write(tmp_path / "course.zip", course)
    assert caplog.messages == []


# ---- The manifest


def test_the_manifest_knows_every_file(contents, manifest):
    assert manifest["format"] == 1
    assert re.fullmatch(r"\d+\.\d+\.\d+", manifest["course"])
    assert f'\nversion = "{manifest["course"]}"\n' in contents["pyproject.toml"].decode()
    found = {path: sha256(content).hexdigest() for path, content in contents.items() if path != "manifest.json"}
    assert manifest["files"] == found


def test_the_manifest_knows_every_exercise(course, manifest):
    expected = {}
    for path in sorted((course / "notebooks").glob(reference.PATTERN)):
        chapter = reference.Chapter(path.name, path.read_text())
        for task in chapter.tasks:
            cells = {role: chapter.cell(role, task.name) for role in ("exercise", "answer", "check")}
            expected[task.name] = {
                "notebook": f"notebooks/{chapter.file}",
                "points": task.points,
                "cells": {role: cell.id for role, cell in cells.items()},
                "check_sha256": sha256(cells["check"].source.encode()).hexdigest(),
            }
    assert manifest["exercises"] == expected
    assert manifest["exercises"]["topics-2"]["cells"] == {
        "exercise": "topics-ex2",
        "answer": "topics-ex2-answer",
        "check": "topics-ex2-check",
    }


def test_the_manifest_is_sorted_text(contents, manifest):
    assert contents["manifest.json"].decode() == json.dumps(manifest, indent=1, sort_keys=True) + "\n"


# ---- Fit for use


def run(folder: Path, *command: str, **variables: str) -> subprocess.CompletedProcess[str]:
    environ = fresh_environ(PYTHON=BASE_PYTHON, **variables)
    return subprocess.run(command, cwd=folder, env=environ, capture_output=True, text=True, timeout=60)


def test_the_machine_is_checked_as_unpacked(unpacked):
    assert not (unpacked / "tests").exists()
    report = json.loads(run(unpacked, "./environment-check.sh", "--json").stdout)
    assert {check["name"]: check["status"] for check in report["checks"]}["environment"] == "WARN"


def test_unzip_keeps_what_can_be_executed(edition, tmp_path):
    if shutil.which("unzip") is None:
        pytest.skip("needs unzip")
    subprocess.run(["unzip", "-q", str(edition), "-d", str(tmp_path)], check=True, timeout=60)
    assert "lab" in run(tmp_path / release.TOP, "./environment-check.sh", "--help").stdout


def test_the_fault_labs_programs_are_files(course, unpacked):
    # Links in the clone, which many programs that unpack a zip do not make.
    for program in ("map_server", "planner", "scanner", "simulator"):
        installed = unpacked / "course_kit/exercises/faults/robot/lib/patrol" / program
        assert not installed.is_symlink()
        assert os.access(installed, os.X_OK)
        assert installed.read_bytes() == (course / f"course_kit/exercises/faults/programs/{program}.py").read_bytes()


def test_progress_is_shown(unpacked, tmp_path):
    command = (sys.executable, "-m", "course_kit.classroom.course_command", "progress")
    shown = run(unpacked, *command, XDG_STATE_HOME=str(tmp_path))
    assert (shown.returncode, shown.stderr) == (0, "")
    assert "topics-1" in shown.stdout


# ---- Refused


def refused(root: Path, path: Path) -> str:
    with pytest.raises(release.Refused) as why:
        release.write(path, root)
    return str(why.value)


def test_a_students_edition_makes_none(unpacked, own, tmp_path):
    assert "is a students' edition itself" in refused(unpacked, tmp_path / "course.zip")
    (own / "manifest.json").write_text("{}")  # a student keeps hers in git
    assert "is a students' edition itself" in refused(own, tmp_path / "course.zip")


def test_what_is_no_clone_of_the_course_makes_none(tmp_path):
    assert "is not a clone of the course" in refused(tmp_path, tmp_path / "course.zip")
    git(tmp_path, "init", "--quiet")
    (tmp_path / "pyproject.toml").write_text('[project]\nname = "another"\nversion = "1.0"\n')
    commit(tmp_path)
    assert "is not a clone of the course" in refused(tmp_path, tmp_path / "course.zip")


def test_without_git_there_is_none(course, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    assert refused(course, tmp_path / "course.zip").startswith("git is not installed")


@pytest.mark.parametrize("copied", [False, True], ids=["changed", "in a copied cell"])
def test_a_solution_in_an_answer_cell_is_not_released(own, tmp_path, copied):
    notebook = nbformat.read(own / TOPICS, as_version=4)
    at, cell = next((n, c) for n, c in enumerate(notebook.cells) if c.id == "topics-ex2-answer")
    if copied:
        cell = nbformat.v4.new_code_cell(metadata=cell.metadata)
        notebook.cells.insert(at, cell)
    cell.source = "class ScanCounter(Node):\n    pass"
    nbformat.write(notebook, own / TOPICS)
    assert refused(own, tmp_path / "course.zip") == (
        f"the answer cell of topics-2 in {TOPICS} is not untouched: it may hold a solution"
    )


def test_a_link_to_what_students_do_not_get_is_refused(own, tmp_path):
    (own / "notebooks/solutions.py").symlink_to("../tests/exercises/topics/styles.py")
    commit(own)
    assert "notebooks/solutions.py is no file of the students' edition" in refused(own, tmp_path / "course.zip")


def test_where_nothing_can_be_written_an_earlier_zip_stays(course, tmp_path, monkeypatch):
    path = tmp_path / "course.zip"
    path.write_bytes(b"an earlier one")

    def fail(*paths: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", fail)
    assert refused(course, path) == (
        f"'{path}' cannot be written: No space left on device. Make room on that disk, or write to another one."
    )
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_bytes() == b"an earlier one"


def test_a_folder_that_is_not_there_is_named(course, tmp_path):
    path = tmp_path / "nowhere" / "course.zip"
    assert refused(course, path) == f"'{path}' cannot be written: No such file or directory"
