"""Tasks on an engine that exists: any concurrent.futures.Executor, or Ray.

A task is a function of plain values, mostly paths, at the top of a module. It leaves what it makes in
files, each written whole or not at all, and skips what is there; what it returns is small. So a task
may run again, or twice at once, and a killed worker or driver costs no more than the tasks it ran.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import threading
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import Any, Callable, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Tuple

#: How often a task is started before the death of its worker is its own fault.
ATTEMPTS = 3

Engine = Callable[[], Executor]
"""Makes an executor; called again when one broke."""


def local(workers: Optional[int] = None) -> Engine:
    """Processes of this machine; workers: None = as many as it has cores."""
    # A forked child would inherit locks that threads of NumPy or pyarrow hold.
    context = multiprocessing.get_context("spawn")
    return lambda: ProcessPoolExecutor(workers, context, initializer=_end_with_driver)


def _end_with_driver() -> None:
    """A worker would wait for ever for the next task of a driver that was killed."""
    driver = multiprocessing.parent_process()

    def watch() -> None:
        if driver is not None:
            driver.join()
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


class RayExecutor(Executor):
    """Ray as an executor: on the cluster of $RAY_ADDRESS, else on this machine."""

    def __init__(self, workers: Optional[int] = None) -> None:
        # Before Ray is imported, and for the workers as well.
        os.environ["RAY_USAGE_STATS_ENABLED"] = "0"
        import ray

        self._ray = ray
        self._started = not ray.is_initialized()
        if self._started:
            address = os.environ.get("RAY_ADDRESS")
            here: Dict[str, Any] = {}
            if address is None:
                here = {"num_cpus": workers, "include_dashboard": False}
            ray.init(
                address=address or "local",
                log_to_driver=False,
                logging_level=logging.ERROR,
                runtime_env={"env_vars": _environment()},
                **here,
            )
        self._remote = ray.remote(max_retries=ATTEMPTS - 1)(_call)

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = self._remote.remote(fn, args, kwargs).future()
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        if self._started:
            self._ray.shutdown()


def _environment() -> Dict[str, str]:
    """What workers elsewhere need of ours."""
    names = ("PYTHONPATH", "PATH", "VDNA_MODELS", "VDNA_ONNXRUNTIME", "RAY_USAGE_STATS_ENABLED")
    return {name: os.environ[name] for name in names if name in os.environ}


def _call(function: Callable[..., Any], args: Sequence[Any], kwargs: Dict[str, Any]) -> Any:
    return function(*args, **kwargs)


def on_ray(workers: Optional[int] = None) -> Engine:
    """Ray; workers: of this machine if there is no $RAY_ADDRESS, None = as many as it has cores."""
    return lambda: RayExecutor(workers)


class Done(NamedTuple):
    """A task that ended."""

    arguments: Tuple[Any, ...]
    result: Any
    """None if it failed."""
    failure: str
    """"" if it did not."""


def run(
    engine: Engine, function: Callable[..., Any], arguments: Iterable[Tuple[Any, ...]], window: int = 0
) -> List[Done]:
    """Run function(*a) for each `a` of arguments; in their order, what became of them.

    A failed task does not stop the others. One whose worker dies runs again on a new executor.

    window: tasks handed over at a time, 0 = four for each core of this machine
    """
    todo = list(arguments)
    done: Dict[int, Done] = {}
    deaths: Dict[int, int] = {}
    size = window or 4 * (os.cpu_count() or 1)
    while len(done) < len(todo):
        # One at a time where a worker died, so that no task suffers for another.
        suspects = [index for index in deaths if index not in done]
        left = suspects or [index for index in range(len(todo)) if index not in done]
        with engine() as executor:
            for index, future in _in_flight(
                executor, function, todo, left, 1 if suspects else size
            ):
                death = future.exception()
                if isinstance(death, BrokenProcessPool):
                    deaths[index] = deaths.get(index, 0) + 1
                    if deaths[index] < ATTEMPTS:
                        continue
                result, failure = (None, _text(death)) if death else future.result()
                done[index] = Done(todo[index], result, failure)
    return [done[index] for index in range(len(todo))]


def _attempt(function: Callable[..., Any], arguments: Tuple[Any, ...]) -> Tuple[Any, str]:
    """In the worker, so that a failure reads the same on every engine."""
    try:
        return function(*arguments), ""
    except Exception as failure:
        return None, _text(failure)


def _text(failure: BaseException) -> str:
    return str(failure) or type(failure).__name__


def _in_flight(
    executor: Executor,
    function: Callable[..., Any],
    todo: List[Tuple[Any, ...]],
    left: List[int],
    size: int,
) -> Iterator[Tuple[int, Future[Any]]]:
    """Ended tasks and their indices; at most `size` are with the executor. Ends early if it broke."""
    waiting = iter(left)
    pending: Dict[Future[Any], int] = {}
    broken = False
    while True:
        while not broken and len(pending) < size:
            index = next(waiting, None)
            if index is None:
                break
            try:
                pending[executor.submit(_attempt, function, todo[index])] = index
            except BrokenProcessPool:
                broken = True
        if not pending:
            return
        for future in wait(pending, return_when=FIRST_COMPLETED).done:
            broken = broken or isinstance(future.exception(), BrokenProcessPool)
            yield pending.pop(future), future
