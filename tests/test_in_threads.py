"""Functions of many points on all cores."""

from __future__ import annotations

import multiprocessing
import threading

import numpy as np
import pytest
from conftest import Array

from pinograsp import threads
from pinograsp.geometry import in_threads
from pinograsp.geometry.in_threads import AT_ONCE

POINTS = np.random.default_rng(0).normal(size=(4 * AT_ONCE + 3, 3))


@pytest.fixture(autouse=True)
def _four_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "_cores", lambda: 4)


def _threads_that_work() -> set[threading.Thread]:
    """Return the threads in which a function is called for some points; every point is to be served."""
    threads, sums = set[threading.Thread](), np.zeros(len(POINTS))

    def add(factor: float, points: Array, found: Array) -> None:
        threads.add(threading.current_thread())
        found[:] = factor * points.sum(axis=1)

    in_threads.in_threads(add, 2.0, POINTS, sums)
    np.testing.assert_array_equal(sums, 2.0 * POINTS.sum(axis=1))
    return threads


def test_threads_do_the_work_and_end() -> None:
    threads = _threads_that_work()
    assert threads
    assert threading.main_thread() not in threads
    assert not any(thread.is_alive() for thread in threads)


def test_a_worker_has_no_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    """There are as many workers as cores."""
    monkeypatch.setattr(multiprocessing, "parent_process", multiprocessing.current_process)
    assert _threads_that_work() == {threading.main_thread()}


def test_a_thread_of_others_has_no_threads() -> None:
    found: list[set[threading.Thread]] = []
    other = threading.Thread(target=lambda: found.append(_threads_that_work()))
    other.start()
    other.join()
    assert found == [{other}]


def test_errors_come_through() -> None:
    def fail(_: float, points: Array) -> None:
        raise ValueError(f"{len(points)} points")

    with pytest.raises(ValueError, match=f"{AT_ONCE} points"):
        in_threads.in_threads(fail, 1.0, POINTS)
