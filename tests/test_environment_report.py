"""The report of the environment check: table, HTML, JSON."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import pytest

from course_kit.setup.environment import report
from course_kit.setup.environment.report import Check, Report, fail, passed, warn


def named(name: str, check: Check) -> Check:
    return replace(check, name=name)


GOOD = named("memory", passed("8000 of 16000 MB available"))
DOUBTFUL = named("conda", warn("/opt/conda is active", "it mixes its libraries with ours", "conda deactivate"))
BAD = named("domain", fail("<b>300</b>", "there is no such domain", "export ROS_DOMAIN_ID=1 && echo done"))


@pytest.mark.parametrize("status", ["WARN", "FAIL"])
@pytest.mark.parametrize(("reason", "cure"), [("", "do it"), ("because", ""), ("", "")])
def test_a_warning_or_failure_must_say_why_and_how_to_cure_it(status, reason, cure):
    with pytest.raises(ValueError, match="without a reason and a cure"):
        Check("name", status, "detail", reason, cure)


def test_the_table_has_a_line_for_each_check_and_reason_and_cure_below_those_not_passed():
    lines = report.text([GOOD, DOUBTFUL, BAD]).splitlines()
    assert [line.split(maxsplit=1)[0] for line in lines] == [
        "PASS", "WARN", "why:", "cure:", "FAIL", "why:", "cure:", "3",
    ]  # fmt: skip
    assert lines[3].endswith("cure: conda deactivate")
    assert lines[-1] == "3 checks: 1 PASS, 1 WARN, 1 FAIL"


def test_the_columns_of_the_table_are_aligned():
    lines = report.text([GOOD, DOUBTFUL]).splitlines()
    assert lines[0].index("8000") == lines[1].index("/opt/conda") == lines[2].index("why:")


def test_colours_are_only_in_the_table_when_asked_for():
    assert "\033[31mFAIL\033[0m" in report.text([BAD], colour=True)
    assert "\033" not in report.text([BAD])


def test_all_cures_that_need_root_are_gathered_in_one_line_to_copy():
    venv = fail("missing", "needed", "sudo apt-get install -y python3.11-venv")
    headers = fail("missing", "needed", "sudo apt-get install -y python3.11-dev")
    jazzy = fail("aarch64", "no wheels", "sudo apt-get install -y ros && source setup.bash")
    loopback = fail("down", "needed", "sudo ip link set lo up")
    wanted = (
        "sudo apt-get update && sudo apt-get install -y python3.11-venv python3.11-dev ros && sudo ip link set lo up"
    )
    checks = [GOOD, venv, DOUBTFUL, headers, jazzy, loopback]
    assert report.text(checks).splitlines()[-1] == f"What needs root, in one line: {wanted}"
    assert json.loads(report.as_json(checks))["root"] == wanted


def test_without_such_a_cure_there_is_no_such_line():
    assert report.for_root([GOOD, DOUBTFUL, BAD]) == ""


def test_json_holds_every_field_and_whether_all_is_well():
    answer = json.loads(report.as_json([GOOD, BAD]))
    assert answer["ok"] is False
    assert answer["checks"][1] == {
        "name": "domain",
        "status": "FAIL",
        "detail": "<b>300</b>",
        "reason": "there is no such domain",
        "cure": "export ROS_DOMAIN_ID=1 && echo done",
    }
    assert json.loads(report.as_json([GOOD, DOUBTFUL]))["ok"] is True


def test_html_escapes_what_was_found():
    page = report.as_html([BAD])
    assert "<b>" not in page
    assert "&lt;b&gt;300&lt;/b&gt;" in page
    assert "<code>export ROS_DOMAIN_ID=1 &amp;&amp; echo done</code>" in page


def contrast(colour: str, other: str = "#ffffff") -> float:
    """The contrast ratio of two colours as the web's accessibility rules (WCAG 2) define it."""

    def luminance(value: str) -> float:
        channels = [int(value[i : i + 2], 16) / 255 for i in (1, 3, 5)]
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    light, dark = sorted((luminance(colour), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def test_html_is_readable_in_a_light_and_a_dark_theme():
    page = report.as_html([GOOD, DOUBTFUL, BAD])
    badges = re.findall(r'<span style="background:(#\w{6});color:#fff;', page)
    assert len(badges) == 3
    assert all(contrast(colour) >= 4.5 for colour in badges)  # WCAG AA
    # Outside the badges the theme's own colours stand.
    assert len(re.findall("background|color:", page)) == 2 * len(badges)


def test_a_report_shows_itself_and_lists_what_failed():
    shown = Report([GOOD, BAD])
    assert shown.failed == [BAD]
    assert repr(shown) == report.text([GOOD, BAD])
    assert shown._repr_html_() == report.as_html([GOOD, BAD])
    assert not Report([GOOD, DOUBTFUL]).failed
