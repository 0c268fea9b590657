"""The form of every chapter for who reads alone: minutes, questions, prompts, places to stop, half an answer."""

from __future__ import annotations

import ast
import itertools
import re
from pathlib import Path

import pytest
from nbformat import NotebookNode

from tests.chapters import PATHS, cells, headings, tags

of_each = pytest.mark.parametrize("path", PATHS, ids=[path.stem for path in PATHS])
of_all_but_the_last = pytest.mark.parametrize("path", PATHS[:-1], ids=[path.stem for path in PATHS[:-1]])
of_all_but_the_first = pytest.mark.parametrize("path", PATHS[1:], ids=[path.stem for path in PATHS[1:]])

TIME = re.compile(r"\*\*Time\*\*[:| ]+(\d+) minutes, the exercises another (\d+)\b(.*)")
MINUTES = re.compile(r"\*(\d+) minutes?(, can be left out)?\*$")
OF_AN_EXERCISE = re.compile(r", about (\d+) minutes?, ")
ENDS = {"Summary", "Exercises", "Next"}  # without minutes of their own
FOLDED = r"<details><summary>Answer</summary>\n\n(?:(?!<details>).)+?\n\n</details>"
QUESTION = re.compile(rf"\*\*Question\.\*\* (?:(?!<details>).)+?\n\n{FOLDED}\Z", re.DOTALL)
SITTING = 45  # minutes at most
LONG = 60  # minutes, from which on a chapter has places to stop
SITTINGS = {"two": 2, "three": 3, "four": 4, "five": 5, "six": 6}
CELLS_A_QUESTION = 8
GAP = "____"
HALF_FILLED = f'# Take away the "# " in front (mark the lines, then Ctrl + /) and fill in each {GAP}.'


def exercise_role(cell: NotebookNode) -> str | None:
    mark = cell.metadata.get("course_kit", {})
    return mark["role"] if "exercise" in mark else None


def sections(path: Path) -> list[tuple[int, str, int]]:
    """Those that take time: the number of the cell, the heading, the minutes. AssertionError if one does not tell."""
    found = []
    for heading in headings(cells(path)):
        if heading.level == 2 and heading.text not in ENDS:
            cell = cells(path)[heading.cell]
            line = cell.source[heading.offset :].split("\n")[1:2]
            match = MINUTES.fullmatch(line[0]) if line else None
            assert match, f"{cell.id}: below '## {heading.text}' stands no line like *6 minutes*, but {line}"
            if match[2]:
                assert heading.offset == 0, f"{cell.id}: a section that can be left out begins in a cell of its own"
            found.append((heading.cell, heading.text, int(match[1])))
    return found


def stated_time(path: Path) -> tuple[int, int, str]:
    """Of the title: the minutes of the sections, of the exercises, and what is said besides."""
    title = cells(path)[0]
    match = TIME.search(title.source)
    assert match, f"{title.id} says no time like: **Time**: 55 minutes, the exercises another 40"
    return int(match[1]), int(match[2]), match[3]


def tagged(path: Path, tag: str) -> list[tuple[int, NotebookNode]]:
    return [(number, cell) for number, cell in enumerate(cells(path)) if tag in tags(cell)]


@of_each
def test_the_minutes_of_the_sections_add_up_to_the_titles(path: Path) -> None:
    minutes = [minutes for _, _, minutes in sections(path)]
    assert stated_time(path)[0] == sum(minutes), f"{cells(path)[0].id}: the sections take {'+'.join(map(str, minutes))}"


@of_each
def test_the_minutes_of_the_exercises_add_up_to_the_titles(path: Path) -> None:
    texts = [cell.source for cell in cells(path) if exercise_role(cell) == "exercise"]
    minutes = [int(found) for text in texts for found in OF_AN_EXERCISE.findall(text.splitlines()[1])]
    assert len(minutes) == len(texts)
    assert stated_time(path)[1] == sum(minutes), f"{cells(path)[0].id}: the exercises: {'+'.join(map(str, minutes))}"


@of_each
def test_a_question_stands_about_every_eight_cells(path: Path) -> None:
    count = sum(exercise_role(cell) is None for cell in cells(path))
    questions = len(tagged(path, "question"))
    assert questions >= count // CELLS_A_QUESTION, f"{path.stem}: {questions} questions in {count} cells"


@of_each
def test_each_question_has_its_answer_folded_and_a_later_cell_that_shows_it(path: Path) -> None:
    code = {cell.id: number for number, cell in enumerate(cells(path)) if cell.cell_type == "code"}
    for number, cell in tagged(path, "question"):
        assert cell.cell_type == "markdown", cell.id
        assert QUESTION.search(cell.source.strip()), f"{cell.id}: not the form of a question"
        answer = cell.metadata.get("answered_by")
        assert answer in code, f"{cell.id} is answered_by {answer}, which is no code cell of the chapter"
        assert number < code[answer], f"{cell.id} stands behind {answer}, which answers it"


@of_each
def test_three_prompts_or_more_ask_to_change_something(path: Path) -> None:
    prompts = [cell for _, cell in tagged(path, "try")]
    assert len(prompts) >= 3, f"{path.stem}: {len(prompts)} prompts"
    for cell in prompts:
        assert cell.cell_type == "markdown" and cell.source.startswith("**Change this.**"), cell.id


@of_each
def test_what_looks_like_a_question_a_prompt_or_a_stop_is_tagged(path: Path) -> None:
    for words, tag in (("**Question.**", "question"), ("**Change this.**", "try"), ("**A place to stop.**", "stop")):
        for cell in cells(path):
            assert words not in cell.source or tag in tags(cell), f"{cell.id} has no tag {tag}"


@of_all_but_the_first
def test_three_questions_on_the_chapter_before_come_right_after_the_title(path: Path) -> None:
    assert [number for number, _ in tagged(path, "recap")] == [1], f"{path.stem}: a recap is the second cell"
    recap = cells(path)[1]
    assert len(re.findall(FOLDED, recap.source, re.DOTALL)) == recap.source.count("<details>") == 3, recap.id


@of_each
def test_a_long_chapter_has_places_to_stop(path: Path) -> None:
    stops = [number for number, _ in tagged(path, "stop")]
    minutes, _, besides = stated_time(path)
    if minutes > LONG:
        parts = [0, *stops, len(cells(path))]
        for begin, end in itertools.pairwise(parts):
            part = [(text, minutes) for cell, text, minutes in sections(path) if begin <= cell < end]
            total = sum(minutes for _, minutes in part)
            assert total <= SITTING, f"{path.stem}: {total} minutes from '{part[0][0]}' on without a place to stop"
        match = re.search(r"\b(\d|two|three|four|five|six) sittings\b", besides.lower())
        assert match, f"{cells(path)[0].id}: **Time** does not say how many sittings"
        assert int(SITTINGS.get(match[1], match[1])) == len(stops) + 1, f"{cells(path)[0].id}: {len(stops)} stops"


@of_each
def test_behind_each_place_to_stop_one_cell_goes_on(path: Path) -> None:
    for number, cell in tagged(path, "stop"):
        assert cell.cell_type == "markdown" and cell.source.startswith("**A place to stop.**"), cell.id
        assert "resume" in tags(cells(path)[number + 1]), f"the cell behind {cell.id} is not tagged resume"
    for number, cell in tagged(path, "resume"):
        assert "stop" in tags(cells(path)[number - 1]), f"the cell before {cell.id} is no place to stop"
        assert cell.id.endswith("-resume"), cell.id
        assert cell.source == f'from course_kit import catch_up\n\ncatch_up("{cell.id}")', cell.id


@of_each
def test_an_exercise_is_half_filled(path: Path) -> None:
    filled = [cell for cell in cells(path) if exercise_role(cell) == "answer" and GAP in cell.source]
    assert filled, f"{path.stem}: no answer cell with a gap {GAP}"
    for cell in filled:
        first, *given = cell.source.splitlines()
        assert first == HALF_FILLED, cell.id
        assert any(GAP in line for line in given), f"{cell.id} has no gap"
        assert all(line == "#" or line.startswith("# ") for line in given if line), f"{cell.id} is not a comment"
        code = "\n".join(line[2:] for line in given).replace(GAP, "gap")
        if not re.search(r"^[%!]", code, re.MULTILINE):
            ast.parse(code)


@of_all_but_the_last
def test_next_links_to_the_next_chapter(path: Path) -> None:
    """Other ways to go on come behind it."""
    text = cells(path)[-1].source
    assert text.startswith("## Next\n"), path.stem
    assert re.findall(r"\]\((\w+\.ipynb)\)", text)[:1] == [PATHS[PATHS.index(path) + 1].name]


def test_the_forms_are_told_from_others() -> None:
    question = "**Question.** Which?\n\n<details><summary>Answer</summary>\n\nThe last.\n\n</details>"
    assert QUESTION.search(question)
    assert QUESTION.search(f"Fifty messages come.\n\n{question}")
    assert not QUESTION.search(question.replace("\n\nThe", "\nThe"))
    assert not QUESTION.search("**Question.** Which?\n\nThe last.")
    assert not QUESTION.search(f"{question}\n\nAnd on.")
    assert TIME.search("| **Time** | 55 minutes, the exercises another 40. |")
    assert TIME.search("**Time**: 55 minutes, the exercises another 40.")
    assert MINUTES.fullmatch("*15 minutes, can be left out*")
    assert not MINUTES.fullmatch("*about 6 minutes*")
