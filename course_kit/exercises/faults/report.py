"""A report of the fault lab: text that is also true or false. Pure."""

from __future__ import annotations

from dataclasses import dataclass

from course_kit.exercises.protocol.verdict import in_code


@dataclass(frozen=True)
class Report:
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
