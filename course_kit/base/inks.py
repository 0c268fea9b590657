"""Colours of text that tell good from bad; on a light page and on a dark one each has the contrast that WCAG asks for.

No one colour has that on both, so each takes a part of the page's own text colour: a CSS `color` for HTML outputs.
"""

from __future__ import annotations

SHARE = 70  # percent of the hue


def _on_any_page(hue: str) -> str:
    return f"color-mix(in srgb, {hue} {SHARE}%, currentColor)"


GOOD, CAUTION, BAD, FAINT = map(_on_any_page, ("#2e8b57", "#b58900", "#dc322f", "#808080"))
