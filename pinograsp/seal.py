"""Seals of files in caches: what was damaged is told from what was written, whatever library reads it."""

from __future__ import annotations

from hashlib import sha256

SIZE = 32
"""Bytes at the end of a file, the SHA-256 of those before them."""


def sealed(content: bytes) -> bytes:
    """Return content with its seal."""
    return content + sha256(content).digest()


def unsealed(whole: bytes) -> bytes | None:
    """Return the content of what was sealed; None if that was damaged, or never sealed."""
    content, seal = whole[:-SIZE], whole[-SIZE:]
    return content if sha256(content).digest() == seal else None
