"""Tables as text, names told apart, and the line with which what is shown over time says that it failed."""

from __future__ import annotations

from collections.abc import Sequence


def table(rows: Sequence[Sequence[str]], left: int = 1) -> str:
    """Rows of cells as aligned lines; the first `left` columns stand to the left, the others to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for row in rows:
        cells = [c.ljust(w) if n < left else c.rjust(w) for n, (c, w) in enumerate(zip(row, widths, strict=True))]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


def numbered(names: Sequence[str]) -> list[str]:
    """Names, of which those that occur twice are numbered."""
    return [f"{n} ({names[: i + 1].count(n)})" if names.count(n) > 1 else n for i, n in enumerate(names)]


def stands_still(what: str, error: Exception) -> str:
    """What is said where something that should go on has failed: that it did, why, and how to go on."""
    return f"{what} stands still: {type(error).__name__}: {error}. Run its cell again to go on."
