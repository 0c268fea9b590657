"""ExecuteProcess: an action that is a process, from its start to its end, restarts included."""

from __future__ import annotations

import asyncio
import itertools
import os
import re
import shlex
import signal
import traceback
from collections.abc import Iterable, Mapping
from typing import Any

from course_kit.base.programs import orphans
from course_kit.cli.launching import events, output
from course_kit.cli.launching.child import Child
from course_kit.cli.launching.context import LaunchContext
from course_kit.cli.launching.entities import Action, Entities, LaunchDescriptionEntity
from course_kit.cli.launching.event_actions import EmitEvent
from course_kit.cli.launching.handlers import OnProcessExit, OnShutdown, Response, as_list, on_event
from course_kit.cli.launching.substitutions import (
    LaunchConfiguration,
    SomeSubstitutions,
    as_bool,
    as_text,
    is_substitution,
    normalize,
    perform,
)

_numbers = itertools.count(1)
Environment = Mapping[Any, SomeSubstitutions]


class ExecuteProcess(Action):
    """Runs a command. Its processes are asked to end with the launch: SIGINT, then SIGTERM, then SIGKILL."""

    def __init__(
        self,
        *,
        cmd: Iterable[SomeSubstitutions],
        prefix: SomeSubstitutions | None = None,
        name: SomeSubstitutions | None = None,
        cwd: SomeSubstitutions | None = None,
        env: Environment | None = None,
        additional_env: Environment | None = None,
        shell: bool = False,
        sigterm_timeout: Any = None,
        sigkill_timeout: Any = None,
        emulate_tty: bool = False,
        output: Any = "log",
        output_format: str = "[{this.process_description.final_name}] {line}",
        cached_output: bool = False,
        log_cmd: bool = False,
        on_exit: Response = None,
        respawn: bool | SomeSubstitutions = False,
        respawn_delay: float | None = None,
        respawn_max_retries: int = -1,
        **options: Any,
    ) -> None:
        super().__init__(**options)
        self.cmd = [normalize(part) for part in cmd]
        self.shell = shell
        self.cwd = None if cwd is None else normalize(cwd)
        self.env = _pairs(env)
        self.additional_env = _pairs(additional_env)
        self._prefix = prefix
        self._name = None if name is None else normalize(name)
        self._timeouts = [
            LaunchConfiguration(name, default="5") if given is None else as_text(given)
            for name, given in (("sigterm_timeout", sigterm_timeout), ("sigkill_timeout", sigkill_timeout))
        ]
        self._emulate_tty = emulate_tty
        self._output = os.environ.get("OVERRIDE_LAUNCH_PROCESS_OUTPUT") or output
        self._output_format = output_format
        self._cached: dict[str, list[str]] | None = {"stdout": [], "stderr": []} if cached_output else None
        self._log_cmd = log_cmd
        self._on_exit = on_exit
        self._respawn = respawn
        self._respawn_delay = respawn_delay
        self._retries_left = respawn_max_retries  # negative: no end of them
        self.name = self.final_name = ""  # such as talker-1, once it is executed
        self.process_description = self  # where output_format finds the final name
        self.process_details: dict[str, Any] = {}
        self.return_code: int | None = None
        self._child: Child | None = None
        self._task: asyncio.Task[None] | None = None
        self._timers: list[asyncio.TimerHandle] = []

    def get_stdout(self) -> str:
        """What it wrote to stdout, if cached_output is on."""
        return self._from_cache("stdout")

    def get_stderr(self) -> str:
        """What it wrote to stderr, if cached_output is on."""
        return self._from_cache("stderr")

    def _from_cache(self, source: str) -> str:
        if self._cached is None:
            raise RuntimeError(f"{source} of '{self.name}' was not kept: that takes cached_output=True")
        return "".join(self._cached[source])

    def get_sub_entities(self) -> Entities:
        """What is visited when it exits."""
        return [] if callable(self._on_exit) else as_list(self._on_exit)

    def get_asyncio_future(self) -> asyncio.Future[None] | None:
        """Done when it has ended for good."""
        return self._task

    def execute(self, context: LaunchContext) -> None:
        """Start it, and handle the events that are about it."""
        if self._task is not None:
            raise RuntimeError(
                f"one action starts one process, and '{self.name}' was started before: {self.describe()}"
            )
        self._prepare(context)
        if context.is_shutdown:
            return
        self._ending = context.asyncio_loop.create_future()
        for handler in (
            on_event(events.ShutdownProcess, self._on_shutdown_process),
            on_event(events.SignalProcess, self._on_signal),
            OnShutdown(on_shutdown=self._on_shutdown),
            OnProcessExit(target_action=self, on_exit=self._on_exit),
        ):
            context.register_event_handler(handler)
        self._task = context.asyncio_loop.create_task(self._run(context))

    def _prepare(self, context: LaunchContext) -> None:
        """Perform the substitutions."""
        cmd = [perform(context, part) for part in self.cmd]
        if self._prefix is not None:
            cmd = shlex.split(perform(context, self._prefix)) + cmd
        else:
            values = context.launch_configurations
            if re.match(values.get("launch-prefix-filter", ""), os.path.basename(cmd[0])):
                cmd = shlex.split(values.get("launch-prefix", "")) + cmd
        name = os.path.basename(cmd[0]) if self._name is None else perform(context, self._name)
        name = self.name = self.final_name = f"{name}-{next(_numbers)}"
        environment = dict(context.environment) if self.env is None else {}
        for key, value in [*(self.env or ()), *(self.additional_env or ())]:
            environment[perform(context, key)] = perform(context, value)
        cwd = None if self.cwd is None else perform(context, self.cwd)
        self.process_details = {"action": self, "name": name, "cmd": cmd, "cwd": cwd, "env": environment, "pid": 0}
        self._words = " ".join(part for part in cmd if part.strip())
        self._respawn = as_bool(perform(context, as_text(self._respawn)))
        self._logger = output.get_logger(self.name)
        config = self._output
        if isinstance(config, str) or is_substitution(config):
            config = perform(context, config)
        self._destinations = output.destinations_of(config)
        self._sigterm_timeout, self._sigkill_timeout = (perform(context, t) for t in self._timeouts)

    async def _run(self, context: LaunchContext) -> None:
        while not self._ending.done():
            try:
                self._child = self._start(context)
            except Exception as error:
                self._logger.error(f"exception occurred while executing process: {error}")
                self._logger.debug(traceback.format_exc())
                break
            self.return_code = await self._child.ended
            self._report_end(self.return_code, context)
            if context.is_shutdown or self._ending.done() or not self._respawn or self._retries_left == 0:
                break
            self._retries_left -= 1
            if self._respawn_delay:
                await asyncio.wait({self._ending}, timeout=float(self._respawn_delay))
        for timer in self._timers:
            timer.cancel()

    def _start(self, context: LaunchContext) -> Child:
        details = self.process_details
        if self._log_cmd:
            self._logger.info(f"process details: cmd='{self._words}', cwd='{details['cwd']}', custom_env?=True")
        wants_tty = context.launch_configurations.get("emulate_tty", str(bool(self._emulate_tty)))
        environment = orphans.with_mark(details["env"], context.token)
        child = Child(
            context.asyncio_loop, details["cmd"], details["cwd"], environment, self.shell, as_bool(wants_tty),
            on_data=lambda source, data: self._on_data(context, source, data), on_line=self._on_line,
        )  # fmt: skip
        details["pid"] = child.process.pid
        self._logger.info(f"process started with pid [{child.process.pid}]")
        context.emit_event_sync(events.ProcessStarted(**details))
        return child

    def _report_end(self, code: int, context: LaunchContext) -> None:
        pid = self.process_details["pid"]
        if code == 0:
            self._logger.info(f"process has finished cleanly [pid {pid}]")
        else:
            self._logger.error(f"process has died [pid {pid}, exit code {code}, cmd '{self._words}'].")
        context.emit_event_sync(events.ProcessExited(returncode=code, **self.process_details))

    def _on_data(self, context: LaunchContext, source: str, data: bytes) -> None:
        if self._cached is not None:
            self._cached[source].append(data.decode(errors="replace"))
        event_type = events.ProcessStdout if source == "stdout" else events.ProcessStderr
        event = event_type(text=data, **self.process_details)
        if context.would_handle_event(event):
            context.emit_event_sync(event)

    def _on_line(self, source: str, line: str) -> None:
        line = self._output_format.format(line=line, this=self)
        output.write_line(self.name, self._destinations, source, line)

    def _on_shutdown(self, event: events.Shutdown, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        # After Ctrl-C in a terminal the process has its SIGINT already: the whole process group got it.
        return self._shutdown(context, event.due_to_sigint and context.group_interrupted)

    def _on_shutdown_process(
        self, event: events.ShutdownProcess, context: LaunchContext
    ) -> list[LaunchDescriptionEntity]:
        return self._shutdown(context, False) if event.process_matcher(self) else []

    def _shutdown(self, context: LaunchContext, has_sigint: bool) -> list[LaunchDescriptionEntity]:
        if self._ending.done():
            return []
        self._ending.set_result(None)
        if self._child is None or self._child.ended.done():
            return []
        loop = context.asyncio_loop
        first, second = self._sigterm_timeout, str(float(self._sigterm_timeout) + float(self._sigkill_timeout))
        self._timers = [
            loop.call_later(float(first), self._escalate, context, first, signal.SIGINT, signal.SIGTERM),
            loop.call_later(float(second), self._escalate, context, second, signal.SIGTERM, signal.SIGKILL),
        ]
        if has_sigint and not context.noninteractive:
            return []
        return [EmitEvent(event=self._signal(signal.SIGINT, has_sigint))]

    def _signal(self, number: signal.Signals, is_there_already: bool = False) -> events.SignalProcess:
        event = events.SignalProcess(signal_number=number, process_matcher=events.matches_action(self))
        event.is_there_already = is_there_already
        return event

    def _escalate(self, context: LaunchContext, seconds: str, sent: signal.Signals, number: signal.Signals) -> None:
        self._logger.error(
            f"process[{self.name}] failed to terminate '{seconds}' seconds after receiving '{sent.name}', "
            f"escalating to '{number.name}'"
        )
        context.emit_event_sync(self._signal(number))

    def _on_signal(self, event: events.SignalProcess, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        if not event.process_matcher(self):
            return []
        if self._child is None:
            raise RuntimeError("there is no process yet that a signal could be sent to")
        if self._child.ended.done():
            return []
        self._logger.info(f"sending signal '{event.signal_name}' to process[{self.name}]")
        if not event.is_there_already:  # a second one would break into the process's clean-up
            self._child.process.send_signal(event.signal)
        return []


def _pairs(environment: Environment | None) -> list[tuple[Any, Any]] | None:
    return None if environment is None else [(normalize(k), normalize(v)) for k, v in environment.items()]
