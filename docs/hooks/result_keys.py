"""The keys of result files as tables, from the classes of results: keys and attributes have the same names."""

from __future__ import annotations

from attribute_docstrings import Docstrings


def result_keys(docstrings: Docstrings) -> str:
    """Return a section with a table for every kind of block, as Markdown."""
    return ""
