"""Errors that a user can mend: each names the file, the key, what is wrong and what to do.

A search that finds nothing is not an error; it is a `Result` without grasps that says what blocked it.
"""

from __future__ import annotations

import operator
from pathlib import Path


class PinograspError(Exception):
    """Base of every error that pinograsp raises on purpose."""


class InputError(PinograspError):
    """A file, a key or an argument that cannot be used as given.

    The message reads `file:line: key: problem. remedy`, with the parts that are known.
    """

    def __init__(
        self,
        problem: str,
        *,
        file: Path | str | None = None,
        line: int | None = None,
        key: str | None = None,
        remedy: str | None = None,
    ) -> None:
        self.problem = problem
        self.file = None if file is None else Path(file)
        self.line = line
        self.key = key
        self.remedy = remedy
        where = "" if file is None else f"{file}:{line}: " if line else f"{file}: "
        what = f"{key}: {problem}" if key else problem
        super().__init__(where + what + (f". {remedy}" if remedy else ""))

    def __reduce__(self) -> tuple[object, ...]:
        """Keep the parts when the error crosses from a worker process."""
        return (_rebuild, (self.problem, self.file, self.line, self.key, self.remedy))


class UnknownNameError(InputError, KeyError):
    """A name that nothing has; the message names close ones."""

    def __str__(self) -> str:
        """Return the message, which a `KeyError` would put in quotation marks."""
        return str(self.args[0])


class WorkerLostError(PinograspError):
    """A worker process ended twice over the same piece of work: killed, out of memory, or a library crashed."""


def _rebuild(problem: str, file: Path | None, line: int | None, key: str | None, remedy: str | None) -> InputError:
    return InputError(problem, file=file, line=line, key=key, remedy=remedy)


def whole_number(name: str, number: int, least: int, most: int | None = None) -> int:
    """Return a whole number, NumPy's too, that was given as the argument of a name.

    Raises:
        InputError: it is none, or out of range.
    """
    try:
        whole = operator.index(number)
    except TypeError:
        raise InputError(f"must be a whole number, not {number!r}", key=name) from None
    if whole < least:
        raise InputError(f"must be at least {least}, not {whole}", key=name)
    if most is not None and whole > most:
        raise InputError(f"must be at most {most}, not {whole}", key=name)
    return whole


def close_names(name: str, known: list[str]) -> str:
    """Return a remedy that lists the names closest to `name` among `known`."""
    from difflib import get_close_matches

    close = get_close_matches(name, known, n=3, cutoff=0.5)
    if close:
        return f"Did you mean {' or '.join(close)}?"
    return f"Known: {', '.join(sorted(known)[:12])}" if known else "None is defined"
