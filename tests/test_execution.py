"""Work over processes: warm, closed early, killed; executors that the user gives."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import closing
from functools import partial
from multiprocessing.context import ForkProcess
from pathlib import Path
from queue import SimpleQueue
from typing import Any

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from pinograsp import Robot, SolverOptions
from pinograsp.descriptions import Scene
from pinograsp.errors import InputError, WorkerLostError
from pinograsp.execution import GivenExecutor, Packed, Processes, ThisProcess, Workers, own_workers
from pinograsp.execution.distribute import HOPELESS
from pinograsp.execution.packed import KEPT
from pinograsp.planning.attempt import Attempt, Item, attempts_of
from pinograsp.planning.one_shot import plan
from pinograsp.problem import TaskModel
from pinograsp.solve.local import LocalSolver
from pinograsp.verification import Claim
from pinograsp.verification.check import Verifier

ITEMS = list(range(40))
SQUARES = [item**2 for item in ITEMS]


def squares(log: Path | None = None) -> Callable[[int], int]:
    if log:
        with log.open("a") as lines:
            lines.write(f"{os.getpid()}-{threading.get_ident()}\n")
    return lambda item: item**2


def deadly(folder: Path, item: int, times: int) -> Callable[[int], int]:
    """Return a handler whose process is killed over one item, a number of times; earlier ones leave a file."""

    def handle(given: int) -> int:
        deaths = len(list(folder.iterdir()))
        if given == item and deaths < times:
            (folder / str(deaths)).touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return given**2

    return handle


class Dropping(SimpleQueue[Any]):
    """A queue whose third item is taken as Ctrl-C comes."""

    taken = 0

    def get(self, *args: Any, **keys: Any) -> Any:
        item = super().get(timeout=10.0)
        self.taken += 1
        if self.taken == 3:
            raise KeyboardInterrupt
        return item


def raising(where: str) -> Callable[[int], int]:
    if where == "prepare":
        raise InputError("no such thing", key="prepare")

    def handle(item: int) -> int:
        if item == 13:
            raise InputError("no such thing", key="item")
        return item

    return handle


def lost_square(item: int, reason: str) -> int:
    assert "terminated" in reason or "KilledWorker" in reason
    return -item


@pytest.mark.parametrize("count", [1, 2, 3])
def test_every_item_has_its_outcome(count: int) -> None:
    with own_workers(count) as workers:
        assert sorted(workers.run(squares, ITEMS, chunk=3)) == SQUARES
        assert list(workers.run(squares, [])) == []


def blas_threads(*_: object) -> set[int]:
    """Return the numbers of threads that the libraries of linear algebra use now."""
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


def counting_threads() -> Callable[[int], tuple[set[int], set[int]]]:
    prepared = blas_threads()
    return lambda item: (prepared, blas_threads())


@pytest.mark.parametrize("count", [1, 2])
def test_blas_has_one_thread_where_items_are_handled(count: int) -> None:
    """With any number of workers: sums have the same order, and threads do not wait for each other."""
    with threadpool_limits(2), own_workers(count) as workers:
        for outcome in workers.run(counting_threads, range(3), chunk=1):
            assert outcome == ({1}, {1})
            assert blas_threads() == {2}  # of whoever consumes the outcomes


def test_handlers_stay_warm_and_so_do_processes(tmp_path: Path) -> None:
    first, second = partial(squares, tmp_path / "first"), partial(squares, tmp_path / "second")
    with Processes(2) as workers:
        for prepare in (first, second, first, first, second):
            assert sorted(workers.run(prepare, ITEMS, chunk=1)) == SQUARES
    prepared = [(tmp_path / name).read_text().split() for name in ("first", "second")]
    assert all(len(lines) == len(set(lines)) <= 2 for lines in prepared)
    assert len({line for lines in prepared for line in lines}) <= 2


def test_a_warm_chunk_costs_little() -> None:
    with Processes(1) as workers:
        list(workers.run(squares, [0]))
        began = time.perf_counter()
        list(workers.run(squares, range(200), chunk=1))
        assert (time.perf_counter() - began) / 200 < 0.005


@pytest.mark.parametrize("workers", [ThisProcess(), Processes(2)])
@pytest.mark.parametrize("where", ["prepare", "item"])
def test_exceptions_reach_the_caller_as_themselves(workers: Workers, where: str) -> None:
    with workers, pytest.raises(InputError, match="no such thing") as caught:
        list(workers.run(partial(raising, where), ITEMS))
    assert caught.value.key == where


def test_outcomes_before_an_exception_are_kept() -> None:
    seen = []
    with Processes(2) as workers, pytest.raises(InputError):
        for outcome in workers.run(partial(raising, "item"), list(range(8, 20)), chunk=20):
            seen.append(outcome)  # noqa: PERF402
    assert seen == [8, 9, 10, 11, 12]


def test_traceback_of_a_worker_is_told() -> None:
    with Processes(2) as workers, pytest.raises(ZeroDivisionError) as caught:
        list(workers.run(partial(partial, divmod, 1), [1, 0], chunk=1))
    assert "run_chunk" in caught.value.__notes__[0]


def touch(folder: Path) -> Callable[[int], None]:
    def handle(item: int) -> None:
        (folder / str(item)).touch()
        time.sleep(0.02)

    return handle


def test_closing_drops_what_has_not_begun(tmp_path: Path) -> None:
    with Processes(2) as workers:
        with closing(workers.run(partial(touch, tmp_path), ITEMS, chunk=1)) as outcomes:
            next(outcomes)
        assert sorted(workers.run(squares, ITEMS)) == SQUARES
    assert len(list(tmp_path.iterdir())) < len(ITEMS) / 2


def test_a_worker_that_dies_once_costs_nothing(tmp_path: Path) -> None:
    with Processes(2) as workers:
        assert sorted(workers.run(partial(deadly, tmp_path, 5, 1), ITEMS, chunk=4)) == SQUARES
    assert len(list(tmp_path.iterdir())) == 1


def test_an_item_that_always_kills_its_worker_is_named_and_no_other_is_lost(tmp_path: Path) -> None:
    prepare = partial(deadly, tmp_path, 5, 99)
    with Processes(2) as workers:
        outcomes = sorted(workers.run(prepare, ITEMS, chunk=4, lost=lost_square))
        assert outcomes == sorted([-5, *(square for square in SQUARES if square != 25)])
        assert len(list(tmp_path.iterdir())) == 2
        with pytest.raises(WorkerLostError, match="worker of 5 ended twice"):
            list(workers.run(prepare, ITEMS, chunk=4))
        assert sorted(workers.run(squares, ITEMS)) == SQUARES


def test_an_idle_worker_that_dies_is_replaced(tmp_path: Path) -> None:
    with Processes(1) as workers:
        list(workers.run(partial(squares, tmp_path / "log"), [0]))
        os.kill(int((tmp_path / "log").read_text().split("-")[0]), signal.SIGKILL)
        assert sorted(workers.run(squares, ITEMS)) == SQUARES


def test_ctrl_c_while_processes_begin_leaves_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """Processes that no thread feeds would wait for ever, and this process for them when it ends."""
    start, handler = ForkProcess.start, signal.getsignal(signal.SIGINT)

    def interrupted(process: ForkProcess) -> None:
        start(process)
        os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(ForkProcess, "start", interrupted)
    try:
        with pytest.raises(KeyboardInterrupt), Processes(2) as workers:
            workers.begin()
        assert multiprocessing.active_children() == []
        assert signal.getsignal(signal.SIGINT) is handler
    finally:
        for child in multiprocessing.active_children():
            child.kill()


def killed() -> Callable[[int], int]:
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError


def test_workers_that_always_die_are_given_up() -> None:
    with Processes(2) as workers, pytest.raises(WorkerLostError, match=f"{HOPELESS} workers ended in a row"):
        list(workers.run(killed, ITEMS, lost=lost_square))


def kept_part(part: Packed[list[int]]) -> Callable[[int], int]:
    return lambda item: part.built().append(item) or len(part.built())


def test_builders_share_packed_parts() -> None:
    part: Packed[list[int]] = Packed.of(list)
    with Processes(1) as workers:
        counts = [list(workers.run(partial(kept_part, part), [item])) for item in range(3)]
    assert counts == [[1], [2], [3]]


def test_what_was_used_last_is_kept() -> None:
    packed = [Packed.of(partial(dict, number=i)) for i in range(KEPT + 1)]
    first = packed[0].built()
    for other in packed[1:KEPT]:
        other.built()
    assert packed[0].built() is first
    packed[KEPT].built()
    assert packed[0].built() is first
    for other in packed[1:]:
        other.built()
    assert packed[0].built() is not first


def test_threads_have_handlers_of_their_own(tmp_path: Path) -> None:
    with ThreadPoolExecutor(2) as executor:
        prepare = partial(squares, tmp_path / "log")
        for _ in range(2):
            assert sorted(GivenExecutor(executor).run(prepare, ITEMS, chunk=1)) == SQUARES
    lines = (tmp_path / "log").read_text().split()
    assert len(lines) == len(set(lines)) <= 2


def test_a_given_executor_is_not_shut_down() -> None:
    with ProcessPoolExecutor(1) as executor:
        with GivenExecutor(executor) as workers:
            assert sorted(workers.run(squares, ITEMS)) == SQUARES
        assert executor.submit(abs, -1).result() == 1


class Faulty(Executor):
    """Loses the first calls that it is given."""

    def __init__(self, losses: int) -> None:
        self.losses = losses

    def submit(self, fn: Callable[..., Any], /, *args: Any, **keywords: Any) -> Future[Any]:
        future: Future[Any] = Future()
        self.losses -= 1
        if self.losses >= 0:
            future.set_exception(BrokenExecutor("the worker terminated"))
        else:
            future.set_result(fn(*args, **keywords))
        return future


def test_what_a_given_executor_loses_is_repeated_item_by_item() -> None:
    assert sorted(GivenExecutor(Faulty(3)).run(squares, ITEMS, chunk=4)) == SQUARES
    outcomes = GivenExecutor(Faulty(11)).run(squares, ITEMS, chunk=4, lost=lost_square)
    assert sorted(outcomes) == sorted([0, *SQUARES[1:]])
    outcomes = GivenExecutor(Faulty(13)).run(squares, ITEMS, chunk=4, lost=lost_square)
    assert sorted(outcomes) == sorted([0, -1, -2, *SQUARES[3:]])


def test_an_executor_that_was_shut_down_is_told() -> None:
    executor = ThreadPoolExecutor(1)
    executor.shutdown()
    with pytest.raises(WorkerLostError, match="after shutdown"):
        list(GivenExecutor(executor).run(squares, ITEMS))


def test_a_start_that_kills_its_worker_is_told_and_no_other_is_lost(
    gen3: Robot, glovebox: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = plan(gen3, glovebox, "sphere", starts=12, workers=1)
    solve = LocalSolver.solve

    def kill(self: LocalSolver, index: int, *start: Any) -> Any:
        if index == 3:
            os.kill(os.getpid(), signal.SIGKILL)
        return solve(self, index, *start)

    resistance, heavy = Verifier.resistance, next(grasp for grasp in whole.grasps if grasp.start != 3)

    def kill_again(self: Verifier, claim: Claim) -> Any:
        if claim.joints == heavy.joints:
            os.kill(os.getpid(), signal.SIGKILL)
        return resistance(self, claim)

    monkeypatch.setattr(LocalSolver, "solve", kill)
    monkeypatch.setattr(Verifier, "resistance", kill_again)
    result = plan(gen3, glovebox, "sphere", starts=12, workers=2)
    assert result.warnings == ("the resistance of 1 grasps is not known: workers ended twice over them",)
    assert result.done == 12
    assert result.counts["failed"] == 1
    assert result.blocked["solver failure"].where.startswith("start 3 lost: ")
    others = [grasp for grasp in whole.ranked("U") if grasp.start != 3]
    np.testing.assert_array_equal([g.q_arm for g in result.ranked("U")], [g.q_arm for g in others])


def content(attempts: Iterator[Attempt]) -> list[tuple[Any, ...]]:
    """Everything that attempts came to except times."""
    ordered = sorted(attempts, key=lambda attempt: attempt.solution.start)
    return [
        (s.outcome, s.x.tobytes(), s.evaluations, None if a.grasp is None else a.grasp.to_json())
        for a in ordered
        for s in (a.solution,)
    ]


def test_dask_workers_give_the_same_bytes_when_one_is_killed(
    gen3: Robot, glovebox: Scene, sphere_task: TaskModel, tmp_path: Path
) -> None:
    distributed = pytest.importorskip("distributed")
    rng = np.random.default_rng(0)
    postures = rng.uniform(sphere_task.lower, sphere_task.upper, size=(24, len(sphere_task.lower)))
    prepare = partial(attempts_of, TaskModel(gen3, glovebox, "sphere"), partial(LocalSolver, options=SolverOptions()))
    items = [Item(*start) for start in enumerate(postures)]
    expected = content(ThisProcess().run(prepare, items))
    assert any(outcome == "converged" for outcome, *_ in expected)
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None, local_directory=str(tmp_path)
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        pids = list(client.run(os.getpid).values())
        outcomes = GivenExecutor(client.get_executor()).run(prepare, items, chunk=2)
        attempts = [next(outcomes)]
        os.kill(pids[0], signal.SIGKILL)
        attempts.extend(outcomes)
    assert content(iter(attempts)) == expected


def test_what_is_taken_as_an_interrupt_comes_is_not_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("pinograsp.execution.distribute.SimpleQueue", Dropping)
    found: list[int] = []
    with (
        ThreadPoolExecutor(1) as pool,
        pytest.raises(KeyboardInterrupt),
        closing(GivenExecutor(pool).run(squares, ITEMS, chunk=1)) as running,
    ):
        found.extend(running)
    assert len(found) >= 3
    assert sorted(found) == SQUARES[: len(found)]
