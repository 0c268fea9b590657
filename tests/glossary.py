"""The glossary read, and each term that a chapter uses before it is explained.

`python -m tests.glossary [FILE ...]` prints them all: of notebooks/glossary.md, or of files with some of its lines.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

from nbformat import NotebookNode

from tests.chapters import FOLDER, PATHS, cells, code_spans, headings, prose

GLOSSARY = FOLDER / "glossary.md"
ENTRY = re.compile(
    r"- \*\*(?P<term>[^*]+)\*\*(?: \((?P<forms>[^)]+)\))? · (?P<text>.+?) "
    r"\[(?P<chapter>\d) · (?P<heading>.+?)\]\((?P<file>\d\d_\w+\.ipynb)#(?P<anchor>[^)\s]+)\)"
)
SENTENCE = re.compile(r"(?<=[.!?])\s+(?=[A-Z`%*])|\n\s*\n|\n(?=[|#*-])")
WORDS = 40  # of a sentence, as it is printed


@dataclass(frozen=True)
class Entry:
    """A line of the glossary: the term with its other forms, what it means, where it is explained."""

    term: str
    forms: tuple[str, ...]
    text: str
    chapter: int
    heading: str
    file: str
    anchor: str

    @property
    def all_forms(self) -> tuple[str, ...]:
        return (self.term, *self.forms)


@dataclass(frozen=True)
class TooEarly:
    """A term used before its explanation: where, and in which sentence."""

    entry: Entry
    form: str
    file: str
    cell: str
    sentence: str

    def __str__(self) -> str:
        words = self.sentence.split()
        said = " ".join(words[:WORDS]) + (" …" if len(words) > WORDS else "")
        section = f"{self.entry.file}#{self.entry.anchor}"
        return f"{self.file} {self.cell}: {self.form!r} before {section}\n    {said}"


def entries(text: str) -> list[Entry]:
    """The lines of a glossary that begin with a dash. ValueError for one that has another form."""
    found = []
    for line in text.splitlines():
        if line.startswith("-"):
            match = ENTRY.fullmatch(line.rstrip())
            if not match:
                raise ValueError(f"not the form of an entry: {line}")
            forms = tuple(form.strip() for form in (match["forms"] or "").split(",") if form.strip())
            rest = match.group("text", "heading", "file", "anchor")
            said, heading, file, anchor = rest
            found.append(Entry(match["term"], forms, said, int(match["chapter"]), heading, file, unquote(anchor)))
    return found


def pattern(form: str) -> re.Pattern[str]:
    """How a form is looked for: whole words, in any case, also with an s; a code span as it is."""
    if form.startswith("`"):
        return re.compile(rf"(?<![\w%]){re.escape(form.strip('`'))}(?!\w)")
    words = r"[\s-]+".join(re.escape(word) for word in re.split(r"[\s-]+", form))
    return re.compile(rf"(?<![\w/]){words}(?:s|es)?(?!\w)", re.IGNORECASE)


def uses(form: str, chapter: Sequence[NotebookNode]) -> Iterator[tuple[int, int]]:
    """Where a chapter uses a form, the title apart: the numbers of cells, and where in their text."""
    wanted = pattern(form)
    for number, cell in enumerate(chapter[1:], 1):
        if form.startswith("`"):
            texts = [(0, cell.source)] if cell.cell_type == "code" else list(code_spans(cell.source))
        else:
            texts = [(0, prose(cell.source))] if cell.cell_type == "markdown" else []
        for begin, text in texts:
            yield from ((number, begin + match.start()) for match in wanted.finditer(text))


def explained(entry: Entry, chapter: Sequence[NotebookNode]) -> tuple[int, int] | None:
    """Where the section begins that explains the term; None if the chapter has no such heading."""
    return next((heading.place for heading in headings(list(chapter)) if heading.anchor == entry.anchor), None)


def sentence(text: str, offset: int) -> str:
    """The sentence, or the line of a table or list, that is there."""
    begin = max((match.end() for match in SENTENCE.finditer(text) if match.end() <= offset), default=0)
    end = next((match.start() for match in SENTENCE.finditer(text) if match.start() > offset), len(text))
    return " ".join(text[begin:end].split())


def too_early(entry: Entry, chapters: dict[str, list[NotebookNode]]) -> Iterator[TooEarly]:
    """Every use of a term before its section, in the order of the chapters; all of them if there is no such section."""
    for file, chapter in chapters.items():
        end = explained(entry, chapter) if file == entry.file else None
        for form in entry.all_forms:
            for number, offset in uses(form, chapter):
                if end is None or (number, offset) < end:
                    cell = chapter[number]
                    yield TooEarly(entry, form, file, cell.id, sentence(cell.source, offset))
        if file == entry.file:
            return


def the_chapters() -> dict[str, list[NotebookNode]]:
    """The course's own, in the numbered order."""
    return {path.name: cells(path) for path in PATHS}


def main(files: Sequence[str]) -> int:
    """Print what is used too early; the exit status is 1 if there is any."""
    chapters = the_chapters()
    count = 0
    for file in files or [str(GLOSSARY)]:
        for entry in entries(Path(file).read_text()):
            if explained(entry, chapters.get(entry.file, [])) is None:
                count += 1
                print(f"{entry.term}: {entry.file} has no section {entry.anchor}")
                continue
            for use in too_early(entry, chapters):
                count += 1
                print(use)
    print(f"{count} to mend")
    return int(count > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
