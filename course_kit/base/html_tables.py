"""Tables in HTML, each row of which becomes a card where the page is too narrow: nothing is cut, nothing scrolls."""

from __future__ import annotations

import html
from collections.abc import Sequence

GAP = 2  # characters between two columns
# In a card the cells stand one after the other, each behind its heading; {of} is the class of tables of one width.
NARROW = """{of}{{container-type:inline-size}}@container (width<{width}ch){{\
{of} thead{{position:absolute;width:1px;height:1px;overflow:hidden;clip-path:inset(50%)}}\
{of} table,{of} tbody{{display:block}}\
{of} tr{{display:flex;flex-wrap:wrap;column-gap:2ch;padding:4px 0}}\
{of} td{{white-space:normal!important;overflow-wrap:anywhere;text-align:left!important;padding:0!important}}\
{of} td:first-child{{flex-basis:100%}}\
{of} td+td::before{{content:attr(data-heading) ' ';opacity:.8}}}}"""
CODE = "white-space:pre;font-family:var(--jp-code-font-family,monospace);font-size:var(--jp-code-font-size,13px)"


def of_rows(rows: Sequence[Sequence[str]], left: int = 1) -> str:
    """The table of what text.table() takes: the first row are headings, the first `left` columns stand to the left."""
    head, *body = rows
    width = sum(max(map(len, column)) + GAP for column in zip(*rows, strict=True))
    headings = "".join(_cell("th role='columnheader'", name, number < left) for number, name in enumerate(head))
    records = "".join(f"<tr role='row'>{_record(head, row, left)}</tr>" for row in body)
    name = f"course-kit-table-{width}"
    return (
        f"<div class='{name}' style='{CODE}'><style>{NARROW.format(of=f'.{name}', width=width)}</style>"
        "<table role='table' style='font:inherit;margin:0;border:0;border-collapse:collapse'>"
        f"<thead role='rowgroup'><tr role='row'>{headings}</tr></thead>"
        f"<tbody role='rowgroup'>{records}</tbody></table></div>"
    )


def _record(head: Sequence[str], row: Sequence[str], left: int) -> str:
    return "".join(
        _cell(f"td role='cell' data-heading='{html.escape(name)}'", text, number < left)
        for number, (name, text) in enumerate(zip(head, row, strict=True))
    )


def _cell(tag: str, text: str, is_left: bool) -> str:
    style = f"font:inherit;vertical-align:top;white-space:inherit;padding:1px {GAP}ch 1px 0"
    style += f";text-align:{'left' if is_left else 'right'};font-weight:{'bold' if tag.startswith('th') else 'inherit'}"
    return f"<{tag} style='{style}'>{html.escape(text)}</{tag[:2]}>"
