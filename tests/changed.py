"""Which groups of tests a change can break: by what imports or names what was changed.

What runs in kernels and child processes is found by what the texts of their cells and command lines name.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import grimp
import nbformat

import course_kit
from course_kit.cli.ros2.command import COMMANDS
from course_kit.exercises import catalogue
from course_kit.exercises.solutions import worked
from tests.exercises.chapter import group_of
from tests.landings import ROOT, git

PACKAGES = ("course_kit", "tests")
WORD = re.compile(r"\w+")
NAMED = re.compile(r"\b(?:course_kit|tests)(?:\.\w+)+")
TAKEN = re.compile(r"from (course_kit[\w.]*) import ([\w, ]+)")
CHOOSING = {".ci/landed", "tests/durations.json"}  # each landing changes them, and no test fails by them
ROS2_COMMAND = re.compile(rf"""\bros2\b[\s"',(\[*]+({"|".join(COMMANDS)})\b""")


def changed_files(base: str) -> list[str]:
    """The files that differ from where this branch left a base, such as its upstream: commits, edits, new files.

    Without such a base, those that differ from HEAD.
    """
    left = git("merge-base", "HEAD", base) or ["HEAD"]
    return [*git("diff", "--name-only", *left), *git("ls-files", "--others", "--exclude-standard")]


class Dependencies:
    """What the modules, notebooks and tests of the course depend on."""

    def __init__(self) -> None:
        self.graph = grimp.build_graph(*PACKAGES, cache_dir=None)
        self.texts = {name: text for name, text in self._texts()}
        self.words = {name: {*WORD.findall(text)} for name, text in self.texts.items()}
        for name in self.texts.keys() - self.graph.modules:
            self.graph.add_module(name)
        self.modules = self.graph.modules  # without the groups; grimp collects them anew after each import
        for name, text in self.texts.items():
            for named in () if name == __name__ else self._named(text):
                self._add(name, named)
        for name in self.texts:
            if ".test_" in name:  # pytest loads what is called so in each folder above
                parents = name.split(".")[:-1]
                for length in range(1, len(parents) + 1):
                    self._add(name, ".".join([*parents[:length], "conftest"]))
        notebooks = sorted(name for name in self.texts if name.startswith("notebooks."))
        for chapter, notebook in zip(catalogue.CHAPTERS, notebooks, strict=True):
            self._add(notebook.removeprefix("notebooks."), "tests.test_notebooks")
            self._add(notebook.removeprefix("notebooks."), notebook)
            self._add("tests.chapters", notebook)  # its form, its terms
            modules = ["tests.exercises.test_answers", notebook]
            folders = (ROOT / package / "exercises" / chapter for package in PACKAGES)
            modules += [module_of(path.relative_to(ROOT)) for folder in folders for path in folder.glob("*.py")]
            for group in sorted({group_of(one.name) for one in catalogue.of_chapter(chapter)}):
                for module in modules:
                    self._add(group, module)

    def _texts(self) -> Iterator[tuple[str, str]]:
        for package in PACKAGES:
            for path in (ROOT / package).rglob("*.py"):
                if (name := module_of(path.relative_to(ROOT))) in self.graph.modules:
                    yield name, path.read_text()
        for path in (ROOT / "notebooks").glob("[0-9][0-9]_*.ipynb"):
            yield f"notebooks.{path.stem}", "\n".join(cell.source for cell in nbformat.read(path, as_version=4).cells)

    def _named(self, text: str) -> Iterator[str]:
        """The modules that a text names, in code or in the code of a cell or child process."""
        yield from NAMED.findall(text)
        for package, names in TAKEN.findall(text):
            for name in WORD.findall(names):
                export = course_kit.EXPORTS.get(name) if package == "course_kit" else None
                yield f"course_kit.{export}" if export else f"{package}.{name}"
        for command in ROS2_COMMAND.findall(text):
            yield from (one for one in self.modules if one.startswith(f"course_kit.cli.ros2.{command}"))

    def _add(self, importer: str, imported: str) -> None:
        while imported not in self.modules and "." in imported:
            imported = imported.rpartition(".")[0]  # a name in a module
        for module in {imported, f"{imported}.__main__"} & self.modules - {"course_kit", "tests", importer}:
            self.graph.add_import(importer=importer, imported=module)

    @property
    def groups(self) -> list[str]:
        """The groups of tests: modules, notebooks, and the exercises of a chapter."""
        modules = [name.rpartition(".")[2] for name in self.graph.modules if ".test_" in name]
        return sorted({*modules, *(name for name in self.graph.modules if name[0].isdigit() or " " in name)})

    def touched(self, file: str) -> set[str]:
        """The modules that a changed file is, or that name it; else those of the nearest folder above it."""
        path = Path(file)
        if file in CHOOSING:
            return set()
        if path.suffix == ".ipynb" and f"notebooks.{path.stem}" in self.graph.modules:
            return {f"notebooks.{path.stem}"}
        if module_of(path) in self.graph.modules:
            return {module_of(path)}
        if path.parent.name == worked.FOLDER:
            return {group_of(path.stem), "tests.exercises.test_solutions"} & self.graph.modules
        module = path.parent if path.stem == "__init__" else path
        name = module.stem if path.suffix == ".py" else path.name  # a program is named as a module
        return self._naming(name) or next(filter(None, map(self._in, path.parents[:-1])), set())

    def _naming(self, name: str) -> set[str]:
        """The modules whose text has a name: of those that have its words, for to search in all texts is slow."""
        words, whole = {*WORD.findall(name)}, re.compile(rf"\b{re.escape(name)}\b")
        return {each for each, has in self.words.items() if words <= has and whole.search(self.texts[each])}

    def _in(self, folder: Path) -> set[str]:
        """The modules right in a folder."""
        return {name for name in self.graph.modules if name.rpartition(".")[0] == ".".join(folder.parts)}

    def distances(self, files: Iterable[str]) -> dict[str, int | None]:
        """How many imports lie between each group of tests and what was changed; None for those that do not depend."""
        touched = {one for file in files for one in self.touched(file)}
        found: dict[str, int | None] = {}
        for group in self.groups:
            start = group if group in self.graph.modules else self._module(group)
            chains = [self.graph.find_shortest_chain(start, one) for one in touched - {start}]
            steps = [len(chain) - 1 for chain in chains if chain] + [0] * (start in touched)
            found[group] = min(steps, default=None)
        return found

    def _module(self, group: str) -> str:
        return next(name for name in self.graph.modules if name.endswith(f".{group}"))


def module_of(path: Path) -> str:
    """The name of a module by its file below the course's folder."""
    return ".".join(path.with_suffix("").parts).removesuffix(".__init__")
