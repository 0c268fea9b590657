"""A real Jupyter kernel for tests: runs cells and tells which output arrived for which cell."""

from __future__ import annotations

import contextlib
import tempfile
import time
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path
from queue import Empty
from typing import Any

from jupyter_client.manager import KernelManager

Message = dict[str, Any]


def own_sockets() -> dict[str, str]:
    """Settings that have a KernelManager use sockets in files: a free port may be taken when a kernel starts."""
    return {"transport": "ipc", "ip": f"{tempfile.gettempdir()}/kernel-{uuid.uuid4().hex[:12]}"}


class Kernel:
    """One kernel with its client; every message that it published is kept."""

    def __init__(self, folder: Path | None = None) -> None:
        """`folder` is where it runs, if not here."""
        self.manager = KernelManager(kernel_name="python3", **own_sockets())
        self.manager.start_kernel(**({"cwd": str(folder)} if folder else {}))
        self.connect()

    def connect(self) -> None:
        """Open the channels; also after a restart."""
        self.client = self.manager.client()
        self.client.start_channels()
        self.client.wait_for_ready(timeout=60)
        self.messages: list[Message] = []

    def close(self) -> None:
        self.client.stop_channels()
        self.manager.shutdown_kernel(now=True)

    def send(self, code: str, identity: str = "") -> str:
        """Start a cell, which has an id as in JupyterLab if one is given; return its message id."""
        content = {"code": code, "silent": False, "store_history": True, "user_expressions": {}, "allow_stdin": False}
        metadata = {"cellId": identity} if identity else {}
        message = self.client.session.msg("execute_request", content, metadata=metadata)
        self.client.shell_channel.send(message)
        return str(message["header"]["msg_id"])

    def run(self, code: str, timeout: float = 30.0, identity: str = "") -> str:
        """Run a cell to its end; return its message id. AssertionError if it raised."""
        cell = self.send(code, identity)
        self.finish(cell, timeout)
        errors = self.errors(cell)
        assert not errors, "\n".join(errors[0]["traceback"])
        return cell

    def finish(self, cell: str, timeout: float = 30.0) -> None:
        """Wait until a cell has ended."""
        self.until(lambda: any(m["content"].get("execution_state") == "idle" for m in self.of(cell)), timeout)

    def until(self, condition: Callable[[], Any], timeout: float = 10.0) -> Any:
        """Collect messages until a condition holds; return its value."""
        deadline = time.monotonic() + timeout
        while not (value := condition()):
            assert self.manager.is_alive(), "the kernel has died"
            said = [(m["msg_type"], str(m["content"])[:400]) for m in self.messages[-20:]]
            assert time.monotonic() < deadline, f"not within {timeout} s; the last messages: {said}"
            with contextlib.suppress(Empty):
                self.messages.append(self.client.get_iopub_msg(timeout=0.1))
        return value

    def errors(self, cell: str) -> list[Message]:
        """The errors that a cell raised: `ename`, `evalue` and `traceback` of each."""
        return [m["content"] for m in self.of(cell) if m["msg_type"] == "error"]

    def of(self, cell: str) -> list[Message]:
        """The messages that belong to a cell."""
        return [m for m in self.messages if m["parent_header"].get("msg_id") == cell]

    def text(self, cell: str) -> str:
        """What a cell printed and displayed, as it was first shown."""
        parts = []
        for message in self.of(cell):
            content = message["content"]
            if message["msg_type"] == "stream":
                parts.append(content["text"])
            elif message["msg_type"] in ("display_data", "execute_result"):
                parts.append(content["data"]["text/plain"])
        return "".join(parts)

    def shown(self, cell: str) -> str:
        """The newest content of what a cell displayed, with the updates that came since."""
        first = next(m["content"] for m in self.of(cell) if m["msg_type"] == "display_data")
        identity = first["transient"]["display_id"]
        updates = [
            m["content"]
            for m in self.messages
            if m["msg_type"] == "update_display_data" and m["content"]["transient"]["display_id"] == identity
        ]
        return [first, *updates][-1]["data"]["text/plain"]

    def value(self, code: str) -> str:
        """What an expression gives, as it is printed."""
        cell = self.run(f"print({code})")
        self.until(lambda: self.text(cell))
        return self.text(cell).strip()


@contextlib.contextmanager
def kernel_after(code: str) -> Iterator[Kernel]:
    """A kernel in which this code has run, until the block ends."""
    kernel = Kernel()
    try:
        kernel.run(code)
        yield kernel
    finally:
        kernel.close()
