"""start: programs as child processes of the notebook, as each node is a process of its own on a robot.

What a process writes is kept and shown under the cell that started it. No process outlives the kernel.
"""

from __future__ import annotations

import atexit
import os
import shlex
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from queue import SimpleQueue

from course_kit.base.arguments import COMMAND, ENVIRONMENT, PATH, TEXT, takes
from course_kit.base.programs.child_process import KILL_TIMEOUT, PATIENCE, Process, dismiss_watcher

EXIT_PATIENCE = 1.0  # seconds after SIGINT, and again after SIGTERM, when the kernel ends: Jupyter waits for 5 in all
# Characters that a shell would interpret; start() has none.
SHELL_CHARACTERS = frozenset("|&;<>$`*?~")
# Programs write into a terminal, so each line at once; but without colours, for what is kept is text.
PLAIN_TERMINAL = {"TERM": "dumb", "RCUTILS_COLORIZED_OUTPUT": "0", "COLUMNS": "120"}
# What a kernel sets for itself and no terminal has.
OF_THE_KERNEL = ("CLICOLOR", "CLICOLOR_FORCE", "FORCE_COLOR", "GIT_PAGER", "JPY_PARENT_PID", "MPLBACKEND", "PAGER")
Listener = Callable[["Process"], None]

_lock = threading.RLock()
_processes: dict[str, Process] = {}
listeners: set[tuple[Listener, Listener]] = set()  # of a start, called in its cell, and of each line and the end


@takes(command=COMMAND, name=TEXT | None, environment=ENVIRONMENT | None, folder=PATH | None)
def start(
    command: str | Sequence[str],
    name: str | None = None,
    environment: Mapping[str, str] | None = None,
    folder: Path | str | None = None,
) -> Process:
    """Start a command as you would type it in a terminal, as a process of its own, and return it.

    `start('ros2 run turtlesim turtlesim_node')`; a list of words is taken as it is. `name` stands for it in the
    notebook: the command itself, unless given. An earlier process of the same name is stopped first, so a cell can be
    run again. `environment` (the notebook's) and `folder` (the present one) are the process's.
    Raises ValueError for what only a shell understands, FileNotFoundError for a command that is not there.
    """
    words = _words(command)
    name = name or " ".join(command.split() if isinstance(command, str) else words)
    return begin(words, name, environment, folder, [on_start for on_start, _ in listeners])


def begin(
    words: Sequence[str],
    name: str,
    environment: Mapping[str, str] | None = None,
    folder: Path | str | None = None,
    on_start: Sequence[Listener] = (),
) -> Process:
    """The same with words as they are, and told to none but `on_start`."""
    with _lock:
        earlier = _processes.get(name)
    if earlier is not None:
        earlier.stop()
    whole = {**(without_kernel(os.environ) if environment is None else environment), **PLAIN_TERMINAL}
    process = Process(words, name, whole, None if folder is None else Path(folder), lambda _: _tell(process))
    with _lock:
        _processes[name] = process
        atexit.unregister(_end)
        atexit.register(_end)
    for tell in on_start:
        tell(process)
    process.add_done_callback(_tell)
    process.begin()
    return process


def run_through(
    command: Sequence[str], environment: Mapping[str, str], folder: Path, on_line: Callable[[str], None]
) -> Process:
    """Run a command to its end; `on_line` gets each line in this thread. An interrupt stops it and is passed on."""
    lines: SimpleQueue[str | None] = SimpleQueue()
    process = Process(command, shlex.join(command), environment, folder, lines.put, in_terminal=False)
    process.add_done_callback(lambda _: lines.put(None))
    process.begin()
    try:
        for line in iter(lines.get, None):
            on_line(line)
    finally:
        process.stop()
    return process


def without_kernel(environ: Mapping[str, str]) -> dict[str, str]:
    """An environment as a terminal has it, without what the kernel set for itself."""
    return {name: value for name, value in environ.items() if name not in OF_THE_KERNEL}


def _words(command: str | Sequence[str]) -> list[str]:
    if not isinstance(command, str):
        words = [str(word) for word in command]
    else:
        shell = sorted(SHELL_CHARACTERS.intersection(command))
        try:
            words = shlex.split(command)
        except ValueError as error:
            raise ValueError(f"{command!r} is not a command: {error}") from None
        if shell and not {"'", '"'}.intersection(command):
            raise ValueError(
                f"start() runs one command without a shell, so {' '.join(shell)} has no meaning in {command!r}. "
                f"Write: start(['bash', '-c', {command!r}])"
            )
    if not words:
        raise ValueError("start() needs a command. Write: start('ros2 run package executable')")
    return words


def _tell(process: Process) -> None:
    for _, on_change in list(listeners):
        on_change(process)


def running() -> list[Process]:
    """The processes of start() that run, in the order of their start."""
    with _lock:
        return [process for process in _processes.values() if process.is_running]


def failed() -> list[Process]:
    """Those that have failed, of the same."""
    with _lock:
        return [process for process in _processes.values() if process.state.startswith("failed")]


def stop_all(patience: float = PATIENCE, which: Sequence[Process] | None = None) -> None:
    """Stop processes at the same time; unless given, every process of start()."""
    stopping = running() if which is None else which
    threads = [threading.Thread(target=process.stop, args=(patience,)) for process in stopping]
    for thread in threads:
        thread.start()
    deadline = time.monotonic() + 2 * patience + KILL_TIMEOUT
    for thread in threads:
        thread.join(max(0.0, deadline - time.monotonic()))


def _end() -> None:
    stop_all(EXIT_PATIENCE)
    dismiss_watcher()
