"""Tables for notebooks. Every text is escaped, as names and units come from files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Write a table."""
    lines = [_row("th", head), *(_row("td", row) for row in rows)]
    return f"<table>{''.join(lines)}</table>"


def paragraph(text: str, tag: str = "p") -> str:
    """Write a paragraph, or another element that holds text."""
    return f"<{tag}>{escape(text)}</{tag}>"


def _row(tag: str, cells: Sequence[str]) -> str:
    return f"<tr>{''.join(paragraph(cell, tag) for cell in cells)}</tr>"
