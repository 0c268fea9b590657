"""What grading says in the terminal."""

from __future__ import annotations

from course_kit.classroom.report import table
from tests.grading.test_gradebook import COLOURED, FAILED, a_class, count_down, eight, student


def test_a_line_a_student():
    anna, cmd, bo, *_ = map(table.line, a_class())
    assert anna == "Anna Ångström: 9 of 9 points · topics 6/6 · services 3/3"
    assert cmd == "=cmd|'/c calc'!A1: 1 of 9 points · topics 1/6 · services 0/3 · late"
    assert bo == "bo: 5 of 9 points · topics 5/6 · services 0/3 · could not look at services-1"


def test_the_class_by_chapter():
    assert table.table(a_class()).splitlines() == [
        "student                         topics  services  total    %",
        "  of                                 6         3      9",
        "Anna Ångström                        6         3      9  100",
        "=cmd|'/c calc'!A1                    1         0      1   11  late",
        "bo                                   5        0?     5?   56",
        "<script>alert('name')</script>       1         3      4   44",
        "@zoë                                 0         0      0    0",
        "  mean                             2.0       1.5    3.5   39",
    ]


def test_one_chapter_by_exercise():
    lines = table.table([student("a", count_down(), eight(False)), student("b", count_down())]).splitlines()
    assert lines[0].split() == ["student", "topics-1", "topics-2", "total", "%"]
    assert lines[2].split() == ["a", "2", "0", "2", "33"]
    assert lines[3].split() == ["b", "2", "2", "100"]


def test_nobody_has_handed_in():
    assert table.table([]) == "There are no hand-ins."


def test_names_do_no_harm_in_a_terminal():
    odd = student("a\x1b[2J\nb\u202e" + "c" * 99)
    for shown in (table.line(odd), table.table([odd])):
        assert "\x1b" not in shown and "\u202e" not in shown and "a bccc" in shown and "ccc…" in shown


def test_the_verdicts_of_one():
    shown = table.verdicts(student("anna", count_down(5, COLOURED), FAILED, late=True, notes=("no \x1b[1mworkspace",)))
    assert "topics-1 · Count down: 1 of 2 points\n✘ it counts" in shown
    assert 'check("topics-1", seed=1005) repeats' in shown
    assert shown.splitlines()[-4:] == [
        "! handed in late",
        "! no workspace",
        "! services-1 could not be looked at: its points are open",
        "anna: 1 of 5 points",
    ]
