"""Independent pieces of work over processes: the user's own or those of any `concurrent.futures.Executor`.

    with own_workers(4) as workers:
        for outcome in workers.run(prepare, items): ...

`prepare` builds, once in each process, the handler of items. Pinocchio and Coal hold the interpreter lock, so processes
it is; what an item gives does not depend on their number, nor on those that die.
"""

from .packed import Packed
from .workers import GivenExecutor, Processes, ThisProcess, Workers, own_workers

__all__ = ["GivenExecutor", "Packed", "Processes", "ThisProcess", "Workers", "own_workers"]
