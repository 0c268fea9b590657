"""Answers put into a chapter's notebook one after another, in several kernels beside each other."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from queue import Empty
from typing import Any, NamedTuple

from tests.domains import use_own_domain
from tests.exercises.chapter import Chapter, chapter

CELL_TIMEOUT = 100.0  # seconds for an answer that may build a package, or wait for what never comes
WORKER_TIMEOUT = 600.0


class Put(NamedTuple):
    """An answer to be checked; what it is called is up to the caller."""

    name: str
    exercise: str
    source: str


class Shown(NamedTuple):
    """What a check showed, or that there was no verdict."""

    answer: Put
    text: str
    seconds: float
    raised: str  # by the answer's cell, if anything


class _Notebook:
    """A chapter's notebook, opened anew when an answer has blocked it."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._stack = ExitStack()
        self._open: Chapter | None = None

    def verdict(self, answer: Put) -> tuple[str, str]:
        """Return the text of the check of an answer, and the error that the answer's cell raised, if any."""
        try:
            if self._open is None:
                self._open = self._stack.enter_context(chapter(self._name))
                self._open.begin(answer.exercise)
            kernel = self._open.kernel
            cell = kernel.send(answer.source)
            kernel.finish(cell, CELL_TIMEOUT)
            raised = [error["evalue"] for error in kernel.errors(cell)]
            return self._open.check(answer.exercise), "".join(raised)
        except Exception as error:  # it hangs, or has ended its kernel
            self.close()
            return f"no verdict: {str(error)[:200]}", ""

    def close(self) -> None:
        self._stack.close()
        self._open = None


def _work(name: str, todo: Any, shown: Any) -> None:
    use_own_domain()
    notebook = _Notebook(name)
    while (answer := todo.get()) is not None:
        began = time.monotonic()
        text, raised = notebook.verdict(answer)
        shown.put(Shown(answer, text, time.monotonic() - began, raised))
    notebook.close()


def check_all(name: str, answers: Sequence[Put], kernels: int) -> Iterator[Shown]:
    """Check answers to a chapter's exercises; what each check showed, as it comes.

    It ends early, and says so, when nothing comes any more.
    """
    context = multiprocessing.get_context("spawn")
    todo, shown = context.Queue(), context.Queue()
    for job in [*answers, *[None] * kernels]:
        todo.put(job)
    workers = [context.Process(target=_work, args=(name, todo, shown)) for _ in range(min(kernels, len(answers)))]
    for worker in workers:
        worker.start()
    try:
        for _ in answers:
            yield shown.get(timeout=WORKER_TIMEOUT)
    except Empty:
        print(f"no result in {WORKER_TIMEOUT:g} s", flush=True)
    finally:
        for worker in workers:
            worker.join(60)
            worker.terminate()
