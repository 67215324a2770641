"""Names and numbers of things, as messages say them."""

from __future__ import annotations


def in_words(names: list[str], most: int = 4) -> str:
    """Return names one after the other; of many, the first ones and how many more there are."""
    shown = ", ".join(names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"


def number_of(count: int, what: str) -> str:
    """Return a number with its noun, `1 pad`, `2 pads`."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def escaped(name: str, characters: str) -> str:
    """Return a name without some characters, each written as %XX, and % as %25: different names stay different."""
    return "".join(f"%{ord(c):02X}" if c == "%" or c in characters else c for c in name)
