"""Signs spelled in ASCII, for terminals whose encoding lacks them."""

from __future__ import annotations

SPELLED = {"²": "^2", "³": "^3", "°": "deg", "≥": ">=", "≤": "<=", "…": "...", "─": "-", "━": "-", "╸": "-", "╺": "-"}
"""Signs that tables, units and progress bars have."""


def spelled(error: UnicodeError) -> tuple[str | bytes, int]:
    """Return what is written for characters that an encoding lacks, and where to go on: an error handler of codecs.

    Bytes of file names that are no text are written as they are, other characters as escapes.
    """
    if not isinstance(error, UnicodeEncodeError):
        raise error
    character = error.object[error.start]
    if "\udc80" <= character <= "\udcff":
        return bytes([ord(character) - 0xDC00]), error.start + 1
    escaped = character.encode("ascii", "backslashreplace").decode("ascii")
    return SPELLED.get(character, escaped), error.start + 1
