"""Runs a launch description: handles one event after the other until nothing is left to wait for."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import traceback
from collections.abc import Iterable

from course_kit.base.programs.orphans import Watch
from course_kit.base.shutdown import watchdog
from course_kit.base.shutdown.signals import asking_to_end, leave_closed_terminal
from course_kit.cli.launching import events, output
from course_kit.cli.launching.context import LaunchContext
from course_kit.cli.launching.entities import LaunchDescription, visit_all
from course_kit.cli.launching.handlers import OnShutdown, on_event


class LaunchService:
    """One launch, in the main thread of its process."""

    def __init__(self, *, argv: Iterable[str] | None = None, noninteractive: bool = False, debug: bool = False) -> None:
        self._verbosity = "DEBUG" if debug else "INFO"
        output.show_from(self._verbosity)
        self._logger = output.get_logger("launch")
        self.context = LaunchContext(argv=argv, noninteractive=noninteractive)
        include = on_event(events.IncludeLaunchDescription, lambda event, context: event.launch_description)
        self.context.register_event_handler(include)
        self.context.register_event_handler(OnShutdown(on_shutdown=self._on_shutdown))
        self._futures: list[asyncio.Future[None]] = []
        self._was_interrupted = False
        self._status = 0

    def include_launch_description(self, description: LaunchDescription) -> None:
        """Have a launch description visited when the launch runs."""
        self.context.emit_event_sync(events.IncludeLaunchDescription(description))

    def run(self) -> int:
        """Run to the end; return the exit status. SIGINT, SIGTERM, SIGHUP and SIGQUIT end the launch."""
        self._watch = Watch()
        self.context.token = self._watch.token
        try:
            return asyncio.run(self._run())
        finally:
            self._watch.close()
            for path in self.context.temporary_files:
                with contextlib.suppress(OSError):
                    os.unlink(path)

    async def _run(self) -> int:
        loop = self.context.asyncio_loop = asyncio.get_running_loop()
        terminated = self._terminated = loop.create_future()
        self._logger.info(f"All log files can be found below {output.launch_folder()}")
        self._logger.info(f"Default logging verbosity is set to {self._verbosity}")
        loop.add_signal_handler(signal.SIGINT, self._on_sigint)
        for number in (*asking_to_end(), signal.SIGQUIT):
            loop.add_signal_handler(number, self._on_sigterm, number)
        watchdog.end_after_signals(again=True)  # asyncio has taken the signals to itself
        while not terminated.done():
            if self.context.events:
                self._handle(self.context.events.popleft())
                await asyncio.sleep(0)  # so that processes start and write between two events
                continue
            self._futures = [future for future in self._futures if not future.done()]
            if self._futures:
                waited_for = {self.context.next_arrival(), terminated, *self._futures}
                await asyncio.wait(waited_for, return_when=asyncio.FIRST_COMPLETED)
            elif self.context.is_shutdown:
                break
            else:
                self._shutdown("idle", due_to_sigint=False)
        return self._status

    def _handle(self, event: events.Event) -> None:
        self._logger.debug(f"processing event: '{event}'")
        try:
            for handler in tuple(self.context.handlers):
                if handler.matches(event):
                    self.context.local_values = {}
                    for entity in handler.handle(event, self.context):
                        self._futures += visit_all(entity, self.context)
        except Exception as error:
            hint = ": does a launch file include itself?" if isinstance(error, RecursionError) else ""
            message = f"Caught exception in launch (see debug for traceback): {error}{hint}"
            self._logger.debug(traceback.format_exc())
            self._logger.error(message)
            self._status = 1
            self._shutdown(message, due_to_sigint=False)

    def _on_shutdown(self, event: events.Event, context: LaunchContext) -> None:
        context.is_shutdown = True

    def _shutdown(self, reason: str, due_to_sigint: bool) -> None:
        if not self.context.is_shutdown:
            self.context.emit_event_sync(events.Shutdown(reason=reason, due_to_sigint=due_to_sigint))
        self.context.is_shutdown = True

    def _on_sigint(self) -> None:
        watchdog.let_live()  # nothing holds this process, and its programs may take longer
        message = "user interrupted with ctrl-c (SIGINT)"
        if self._was_interrupted:
            self._logger.warning(f"{message} again, ignoring...")
            return
        self._was_interrupted = True
        self._logger.warning(message)
        self.context.group_interrupted = self._watch.whole_group_was_interrupted()
        self._shutdown("ctrl-c (SIGINT)", due_to_sigint=True)

    def _on_sigterm(self, number: signal.Signals) -> None:
        watchdog.let_live()
        leave_closed_terminal()
        self._status = 1
        if not self._terminated.done():
            self._terminated.set_result(None)
        name = signal.Signals(number).name
        self._logger.error(f"user interrupted with ctrl-\\ ({name}), terminating...")
        self._logger.error(f"using {name} can result in orphaned processes")
        self._logger.error("make sure no processes launched are still running")
        self._logger.error("run task was canceled")
