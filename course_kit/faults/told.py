"""What the fault lab tells the student: text that is also true or false. Pure."""

from __future__ import annotations

from dataclasses import dataclass

from course_kit.examining.verdict import Finding, in_code, mark


@dataclass(frozen=True)
class Told:
    """Some lines, shown as text or as HTML; `bool()` of it says whether what was asked holds."""

    text: str
    ok: bool = True

    def __bool__(self) -> bool:
        return self.ok

    def __repr__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        style = "white-space:pre-wrap;word-break:normal;margin:0"
        return f"<pre class='course-kit-faults' style='{style}'>{in_code(self.text)}</pre>"


def lines_of(findings: list[Finding]) -> list[str]:
    """Findings as a check shows them."""
    lines = []
    for one in findings:
        lines.append(f"{mark(one.ok)} {one.text}")
        if not one.ok:
            lines.append(f"    {one.hint}")
    return lines
