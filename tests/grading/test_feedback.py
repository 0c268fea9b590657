"""The pages: what they say, that they are valid and hold no script, and how a browser shows them."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest
from playwright.sync_api import Page, sync_playwright

from course_kit.classroom.report import feedback
from course_kit.classroom.report.gradebook import file_names
from tests.grading.test_gradebook import EVIL, PROTECTION, TITLE, a_class, count_down, student
from tests.lab import ARGUMENTS, CHROMIUM

VOID = {"meta", "br", "link", "img", "input", "hr"}
INLINE = {"a", "code", "span", "strong", "text"}  # what does not part words
# Of every text on the page: what it says, its contrast with the ground behind it.
CONTRASTS = """() => {
  const channel = c => { c /= 255; return c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; };
  const parts = text => text.match(/[\\d.]+/g).map(Number);
  const light = ([r, g, b]) => 0.2126 * channel(r) + 0.7152 * channel(g) + 0.0722 * channel(b);
  const ground = element => {
    for (let e = element; e; e = e.parentElement) {
      const colour = parts(getComputedStyle(e).backgroundColor);
      if (colour.length < 4 || colour[3] === 1) return colour;
    }
    return [255, 255, 255];
  };
  const found = [];
  for (const element of document.body.querySelectorAll('*')) {
    const said = [...element.childNodes].filter(n => n.nodeType === 3).map(n => n.data).join('').trim();
    if (!said || ['STYLE', 'style', 'SCRIPT'].includes(element.tagName)) continue;
    const style = getComputedStyle(element);
    const ink = light(parts(element.closest('svg') ? style.fill : style.color)), paper = light(ground(element));
    found.push([said, (Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05)]);
  }
  return found;
}"""


class Reader(HTMLParser):
    """A page taken apart; tags that do not match, ids that occur twice, headings that skip a level are errors."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.feed(page)
        self.close()
        assert self.open == []
        ids = [attributes["id"] for _, attributes in self.tags if "id" in attributes]
        assert len(set(ids)) == len(ids)
        levels = [int(tag[1]) for tag, _ in self.tags if re.fullmatch("h[1-6]", tag)]
        assert levels[0] == 1 and levels.count(1) == 1
        assert all(after <= before + 1 for before, after in pairwise(levels))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        names = [name for name, _ in attrs]
        assert len(set(names)) == len(names), f"{tag} has an attribute twice: {names}"
        self.tags.append((tag, dict(attrs)))
        self.text += "" if tag in INLINE else " "
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        self.handle_endtag(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open and self.open.pop() == tag, f"</{tag}> closes nothing"

    def handle_data(self, data: str) -> None:
        if "style" not in self.open:
            self.text += data

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The page of each student of the class, by label, and that of the class."""
    folder = tmp_path_factory.mktemp("grades")
    results = a_class()
    written = feedback.write(results, folder, TITLE)
    assert {file.parent for file in written} == {folder / "feedback"}
    names = file_names(results)
    return {"class": folder / "feedback/class.html"} | {s: folder / f"feedback/{n}.html" for s, n in names.items()}


def text_of(page: Path) -> str:
    return " ".join(Reader(page.read_text()).text.split())


def test_pages_are_valid_and_need_nothing_else(pages):
    for page in pages.values():
        source = page.read_text()
        assert source.startswith("<!DOCTYPE html>\n<html lang=")
        read = Reader(source)
        assert {"name": "color-scheme", "content": "light dark"} in read.all("meta")
        assert not {"script", "link", "img", "iframe", "form", "metadata"} & {tag for tag, _ in read.tags}
        assert all(cell.get("scope") in ("row", "col") for cell in read.all("th"))
        outside = re.findall(r"(?:src|href|url)\s*[=(]\s*[\"']?(?:https?:|//)", source)
        assert outside == []


def test_links_of_the_class_lead_to_its_pages(pages):
    links = {link["href"] for link in Reader(pages["class"].read_text()).all("a")}
    assert len(links) == len(a_class())
    assert all((pages["class"].parent / unquote(str(link))).is_file() for link in links)


def test_no_html_of_students_comes_through(pages):
    for label in (EVIL, "class"):
        source = pages[label].read_text()
        assert "<script" not in source.lower() and "&lt;script&gt;alert(&#39;name&#39;)" in source
    source = pages[EVIL].read_text()
    assert "Traceback &lt;script&gt;alert(&#39;shown&#39;)&lt;/script&gt;\n100 % &amp; done</pre>" in source
    assert not re.search(r"[\x00-\x08\x0b-\x1f\x7f\u202e]", source)


def test_a_student_reads_what_was_found(pages):
    cmd = text_of(pages["=cmd|'/c calc'!A1"])
    assert "1 of 9 points, 11 %" in cmd and "handed in late" in cmd
    assert "✘ it counts 10, 9, … 0 from when somebody listens, and stops (0 of 1 point) Expected 10, 9" in cmd
    assert "✔ it publishes five numbers a second (1 of 1 point)" in cmd
    assert 'checked once, in 3.2 s; check("topics-1", seed=1003) repeats what was drawn for it' in cmd
    assert "not begun, 0 of 3 points Write your answer in the cell above check()." in cmd
    assert "3 · Topics" in cmd and "services-1 · A star" in cmd
    assert "<code>self.timer.cancel()</code>" in pages["=cmd|'/c calc'!A1"].read_text()
    tried_twice = text_of(pages[EVIL])
    assert "checked 2 times" in tried_twice and "Your cell printed" in tried_twice
    assert "The checker itself failed on services-1." in text_of(pages["bo"])
    assert "bo" not in text_of(pages[EVIL]).split(), "nothing of others"


def test_hints_that_differ_only_in_values_count_together(pages):
    read = text_of(pages["class"])
    assert read.count("Expected …, heard … first. Look at self.timer.cancel() in ….") == 1
    hints = feedback._hints(a_class())
    assert [(hint.exercise, len(hint.students)) for hint in hints] == [("topics-1", 3), ("topics-2", 2)]
    twice = student("twice", count_down(1), count_down(2))
    assert [len(hint.students) for hint in feedback._hints([twice])] == [1]
    assert feedback._alike("the node's turtle1 isn't at 'x' or \"y\", but -3.5 m off") == (
        "the node's turtle1 isn't at … or …, but … m off"
    )


def test_the_class_is_counted(pages):
    read = text_of(pages["class"])
    counts = ("students 5", "handed in late 1", "missing: no exercise begun 1", "exercises not begun 4")
    assert all(count in read for count in (*counts, "answers that could not be looked at 1", PROTECTION))
    # of 4, as bo's answer could not be looked at
    assert read.index("services-1 A star 1.5 3 2 2 1") > read.index("topics-1 Count down 1.0 2 1 1 0")
    assert [each.name for each in sorted(feedback._exercises(a_class()), key=lambda e: e.percent)] == [
        "topics-2",
        "topics-1",
        "services-1",
    ]


def test_the_same_results_make_the_same_pages(pages, tmp_path):
    for file in feedback.write(a_class(), tmp_path, TITLE):
        assert file.read_bytes() == (pages["class"].parent / file.name).read_bytes(), file.name


def test_nobody_has_handed_in(tmp_path):
    (page,) = feedback.write([], tmp_path, TITLE)
    assert "students 0" in text_of(page)


@pytest.fixture(scope="module")
def browser_page() -> Iterator[Page]:
    environ: dict[str, Any] = {k: v for k, v in os.environ.items() if k != "LD_LIBRARY_PATH"}
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, headless=True, env=environ, args=ARGUMENTS)
        yield browser.new_page(viewport={"width": 1000, "height": 1000})
        browser.close()


@pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium: sudo apt-get install chromium")
def test_every_text_can_be_read_in_light_in_dark_and_on_paper(
    pages: dict[str, Path], browser_page: Page, tmp_path: Path
) -> None:
    pictures = Path(os.environ.get("COURSE_KIT_PICTURES", tmp_path))  # to look at them
    requests: list[str] = []
    browser_page.on("request", lambda request: requests.append(request.url))
    looks: list[tuple[str, dict[str, Any]]] = [
        ("light", {"media": "screen", "color_scheme": "light"}),
        ("dark", {"media": "screen", "color_scheme": "dark"}),
        ("print", {"media": "print", "color_scheme": "dark"}),
    ]
    for label in ("class", EVIL, "=cmd|'/c calc'!A1", "bo"):
        page = pages[label]
        for look, media in looks:
            browser_page.emulate_media(**media)
            browser_page.goto(page.as_uri())
            browser_page.screenshot(path=pictures / f"{page.stem}-{look}.png", full_page=True)
            contrasts = browser_page.evaluate(CONTRASTS)
            assert len(contrasts) > 20
            assert [(text, ratio) for text, ratio in contrasts if ratio < 4.5] == [], f"{label} in {look}"
            dark = browser_page.evaluate("getComputedStyle(document.body).backgroundColor") != "rgb(255, 255, 255)"
            assert dark == (look == "dark")
            wide = browser_page.evaluate("document.documentElement.scrollWidth > innerWidth")
            assert not wide, f"{label} is wider than the window"
    browser_page.emulate_media(media="screen", color_scheme="light")
    browser_page.goto(pages[EVIL].as_uri())
    shown = browser_page.locator("details pre").first
    assert not shown.is_visible()
    browser_page.emulate_media(media="print")
    assert shown.is_visible(), "paper cannot be unfolded"
    assert {url.partition(":")[0] for url in requests} == {"file"}
