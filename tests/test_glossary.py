"""The glossary: each term once, in order, explained where it says, and in no chapter used before."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import pytest
from nbformat.v4 import new_code_cell, new_markdown_cell

from tests.chapters import PATHS
from tests.glossary import GLOSSARY, Entry, entries, explained, sentence, the_chapters, too_early

EXECUTOR = (
    "- **executor** (single-threaded executor) · It runs callbacks. [1 · What runs them?](01_a.ipynb#What-runs-them?)"
)


def every() -> list[Entry]:
    return entries(GLOSSARY.read_text())


def each() -> Iterator[Any]:
    for entry in every():
        yield pytest.param(entry, id=entry.term)


def test_the_terms_are_in_the_order_of_the_alphabet_and_each_is_there_once() -> None:
    terms = [entry.term.strip("`%").casefold() for entry in every()]
    assert len(terms) >= 60
    assert terms == sorted(terms)
    forms = [form.casefold() for entry in every() for form in entry.all_forms]
    assert [form for form in forms if forms.count(form) > 1] == []


@pytest.mark.parametrize("entry", list(each()))
def test_a_term_has_a_sentence_or_two_and_a_section(entry: Entry) -> None:
    assert entry.text.endswith((".", "?"))
    assert len(re.split(r"(?<=[.!?]) (?=[A-Z`])", entry.text)) <= 2
    file = PATHS[entry.chapter - 1].name
    assert entry.file == file
    assert explained(entry, the_chapters()[file]), f"{file} has no heading with the anchor {entry.anchor}"
    assert entry.anchor == re.sub("[`*]", "", entry.heading).replace(" ", "-")


@pytest.mark.parametrize("entry", list(each()))
def test_a_term_is_used_in_no_chapter_before_it_is_explained(entry: Entry) -> None:
    """All that is too early: python -m tests.glossary."""
    assert not (early := list(too_early(entry, the_chapters()))), "\n".join(map(str, early))


def test_an_entry_that_has_another_form_is_named() -> None:
    assert entries(EXECUTOR)[0].all_forms == ("executor", "single-threaded executor")
    with pytest.raises(ValueError, match="not the form of an entry: - \\*\\*executor"):
        entries(EXECUTOR.replace(" · It", ": It"))


def found(*texts: str) -> list[str]:
    """The cells in which the executor is used too early, if these stand between the title and its section."""
    cells = [new_markdown_cell("# 1 · An executor", id="a-title")]
    cells += [new_markdown_cell(text, id=f"a-{number}") for number, text in enumerate(texts)]
    cells += [new_markdown_cell("One.\n\n## What runs them?\nAn executor.", id="a-section")]
    return [use.cell for use in too_early(entries(EXECUTOR)[0], {"01_a.ipynb": cells})]


@pytest.mark.parametrize(
    "text",
    [
        "The executor waits.",
        "Two Executors wait.",
        "A single-threaded\nexecutor waits.",
        "| node | its executor |",
        "### The executor",
        "See [the executor](01_a.ipynb).",
    ],
)
def test_a_use_before_the_section_is_found(text: str) -> None:
    assert found("Nothing.", text)[0] == "a-1"


@pytest.mark.parametrize(
    "text",
    [
        "`rclpy.executors` and `executor`",
        "```\nexecutor\n```",
        "See [what runs it](01_a.ipynb#executor).",
        "See the [executor](glossary.md#executor).",
        "An executorial act.",
        "## Next\nThe executor.",
    ],
)
def test_code_targets_the_glossary_and_what_comes_next_are_no_uses(text: str) -> None:
    assert found(text) == []


def test_all_chapters_before_the_one_that_explains_are_looked_at_and_none_behind() -> None:
    uses = [new_markdown_cell("# 1", id="x-title"), new_markdown_cell("Executor.", id="x-use")]
    section = [new_markdown_cell("# 2", id="a-title"), new_markdown_cell("## What runs them?", id="a-section")]
    chapters = {"00_x.ipynb": uses, "01_a.ipynb": section, "02_y.ipynb": uses}
    assert [use.file for use in too_early(entries(EXECUTOR)[0], chapters)] == ["00_x.ipynb"]


def test_a_term_in_backticks_is_looked_for_in_code() -> None:
    entry = entries(EXECUTOR.replace("**executor** (single-threaded executor)", "**`%ros2`**"))[0]
    title = new_markdown_cell("# 1", id="a-title")
    section = new_markdown_cell("## What runs them?", id="a-section")
    for cell in (new_code_cell("%ros2 node list", id="a-use"), new_markdown_cell("Run `%ros2 topic`.", id="a-use")):
        assert [use.cell for use in too_early(entry, {"01_a.ipynb": [title, cell, section]})] == ["a-use"]
    for cell in (new_code_cell("!ros2 node list", id="a-use"), new_markdown_cell("The %ros2 magic.", id="a-use")):
        assert list(too_early(entry, {"01_a.ipynb": [title, cell, section]})) == []


def test_the_sentence_is_told() -> None:
    text = "One thing. The executor waits. Then it\nruns.\n\n| a | an executor |\n| b | c |"
    assert sentence(text, text.index("executor")) == "The executor waits."
    assert sentence(text, text.rindex("executor")) == "| a | an executor |"
