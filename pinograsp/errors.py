"""The errors that pinograsp raises on purpose.

    PinograspError
        InputError                  a file, a key or an argument cannot be used as given
            UnknownNameError        nothing has this name; a KeyError, too
            FileError               a file is missing, unreadable, damaged or of another format
                UnwritableError     a file or a folder cannot be written
                DamagedError        a file is not what pinograsp could have written
            DatabaseMismatchError   a start database belongs to another robot, enclosure or margin
            TaskError               a task that cannot be meant with this robot and scene
        MissingExtraError           an optional dependency is not installed
        WorkerLostError             worker processes ended

    CacheWarning                    the cache folder cannot be used, and a temporary one is

Each input error names the file, the key, what is wrong and what to do. A search that finds nothing is not an error; it
is a `Result` without grasps that says what blocked it, or why it had no start.
"""

from __future__ import annotations

import math
import operator
import reprlib
from collections.abc import Iterable
from numbers import Real
from pathlib import Path

MOST = 2**53 - 1
"""Counts above are of nothing that can be done, and floating-point numbers do not hold them exactly."""


class PinograspError(Exception):
    """Base of every error that pinograsp raises on purpose."""


class InputError(PinograspError):
    """A file, a key or an argument that cannot be used as given.

    The message reads `file:line: key: problem. remedy`, with the parts that are known; each is an attribute, too, None
    if it is not known. It is one line, whatever a parser that is quoted, or a name, has in it.
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
        problem, remedy = _one_line(problem), None if remedy is None else _one_line(remedy)
        self.problem = problem
        self.file = None if file is None else Path(file)
        self.line = line
        self.key = key
        self.remedy = remedy
        where = "" if file is None else f"{file}:{line}: " if line else f"{file}: "
        what = f"{key}: {problem}" if key else problem
        super().__init__(_one_line(where + what) + (f". {remedy}" if remedy else ""))

    def __reduce__(self) -> tuple[object, ...]:
        """Keep class and parts when the error crosses from a worker process."""
        return (_rebuild, (type(self), self.problem, self.file, self.line, self.key, self.remedy))


def _one_line(text: str) -> str:
    return " ".join(text.splitlines())


class UnknownNameError(InputError, KeyError):
    """A name that nothing has; the remedy lists close ones."""

    def __str__(self) -> str:
        """Return the message, which a `KeyError` would put in quotation marks."""
        return str(self.args[0])


class FileError(InputError):
    """A file that is missing, cannot be read or written, is damaged, or is of another format."""


class UnwritableError(FileError):
    """A file or a folder that cannot be written: it is read-only or full, or a file is in its way."""


class DamagedError(FileError):
    """A result or a start database that pinograsp cannot have written like this: cut off, changed, or never one."""


class DatabaseMismatchError(InputError):
    """A start database that belongs to another robot, enclosure or margin; the message says in what it differs."""


class TaskError(InputError):
    """A task that cannot be meant with its robot and scene, as where nothing can touch the region of its contacts."""


class MissingExtraError(PinograspError):
    """An optional dependency that is not installed.

    The message gives the command that installs it.

    Args:
        purpose: what needs it, such as "the hold test".
        package: its name.
        extra: of pinograsp that brings it.
    """

    def __init__(self, purpose: str, package: str, extra: str) -> None:
        self.purpose, self.package, self.extra = purpose, package, extra
        super().__init__(f"{purpose} needs {package}. Run pip install 'pinograsp[{extra}]'")

    def __reduce__(self) -> tuple[object, ...]:
        """Keep the parts when the error crosses from a worker process."""
        return (type(self), (self.purpose, self.package, self.extra))


class WorkerLostError(PinograspError):
    """A worker process that ended twice over the same piece of work: killed, out of memory, or a library crashed."""


class CacheWarning(UserWarning):
    """A cache folder that cannot be written: every process makes anew what would be kept there."""


def _rebuild(
    kind: type[InputError], problem: str, file: Path | None, line: int | None, key: str | None, remedy: str | None
) -> InputError:
    return kind(problem, file=file, line=line, key=key, remedy=remedy)


def whole_number(name: str, number: int, least: int, most: int | None = MOST) -> int:
    """Return a whole number, NumPy's too, that was given as the argument of a name.

    Args:
        name: of the argument.
        number: as given.
        least: that it may be.
        most: that it may be; None, as for seeds: any.

    Raises:
        InputError: it is none, or out of range.
    """
    try:
        if isinstance(number, bool):
            raise TypeError
        whole = operator.index(number)
    except TypeError:
        raise InputError(f"must be a whole number, not {number!r}", key=name) from None
    if whole < least:
        raise InputError(f"must be at least {least}, not {whole}", key=name)
    if most is not None and whole > most:
        raise InputError(f"must be at most {most}, not {whole}", key=name)
    return whole


def real_number(name: str, number: float, least: float = -math.inf, most: float = math.inf, *, unit: str = "") -> float:
    """Return a finite number, NumPy's too, that was given as the argument of a name.

    Raises:
        InputError: it is none, as a text or a truth value is none, or out of range; the message has the unit.
    """
    try:
        if isinstance(number, bool) or not isinstance(number, Real):
            raise TypeError
        real = float(number)
    except (TypeError, OverflowError):
        raise InputError(f"must be a number, not {number!r}", key=name) from None
    if not math.isfinite(real):
        raise InputError(f"must be a finite number, not {real}", key=name)
    for holds, side, limit in ((real >= least, "least", least), (real <= most, "most", most)):
        if not holds:
            raise InputError(f"must be at {side} {f'{limit:g} {unit}'.rstrip()}, not {real:g}", key=name)
    return real


def positive_number(name: str, number: float) -> float:
    """Return a finite number above 0, NumPy's too, that was given as the argument of a name.

    Raises:
        InputError: it is none.
    """
    real = real_number(name, number)
    if real <= 0.0:
        raise InputError(f"must be positive, not {real:g}", key=name)
    return real


def require_kind(name: str, value: object, *kinds: type, remedy: str | None = None) -> None:
    """Refuse what was given as the argument of a name and is of no class that is wanted.

    Raises:
        InputError: it is of none.
    """
    if not isinstance(value, kinds):
        wanted = " or ".join(kind.__name__ for kind in kinds)
        raise InputError(f"must be of class {wanted}, not {reprlib.repr(value)}", key=name, remedy=remedy)


def require_report(progress: object) -> None:
    """Refuse what was given as `progress` and cannot be called.

    Raises:
        InputError: it cannot.
    """
    if not callable(progress):
        remedy = "Give a function that takes a pinograsp.Progress"
        raise InputError(f"must be a function, not {progress!r}", key="progress", remedy=remedy)


LISTED = 12
"""Names that a remedy lists at most."""


def close_names(name: object, known: Iterable[str], label: str = "Known") -> str:
    """Return a remedy that lists the names closest to `name` among those known.

    Args:
        name: that nothing has.
        known: those that there are.
        label: what these are, where none is close.
    """
    from difflib import get_close_matches

    names = sorted(set(known))
    close = get_close_matches(str(name), names, n=3, cutoff=0.5)
    if close:
        return f"Did you mean {' or '.join(close)}?"
    if not names:
        return "None is defined"
    return f"{label}: {', '.join(names[:LISTED])}" + (", ..." if len(names) > LISTED else "")
