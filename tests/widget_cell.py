"""A cell of a real kernel that shows a widget, with a test in the browser's place."""

from __future__ import annotations

from typing import Any

from tests.kernel import Kernel, Message

WIDGET = "application/vnd.jupyter.widget-view+json"


class WidgetCell:
    """A cell that has run, and the one widget that it shows."""

    def __init__(self, kernel: Kernel, code: str) -> None:
        self.kernel = kernel
        self.began = len(kernel.messages)
        self.cell = kernel.run(code, identity=f"cell {self.began}")
        shown = [m["content"] for m in kernel.of(self.cell) if m["msg_type"] in ("display_data", "execute_result")]
        (self.first,) = [content for content in shown if WIDGET in content["data"]]
        self.comm = self.first["data"][WIDGET]["model_id"]

    def tell(self, **content: Any) -> None:
        """What the browser says."""
        data = {"method": "custom", "content": content}
        session, channel = self.kernel.client.session, self.kernel.client.shell_channel
        channel.send(session.msg("comm_msg", {"comm_id": self.comm, "data": data}))

    def said(self, kind: str) -> list[tuple[dict[str, Any], list[bytes]]]:
        """What the kernel has said to the browser."""
        customs = [(m["content"]["data"].get("content", {}), m["buffers"]) for m in self.comm_messages()]
        return [(content, list(map(bytes, buffers))) for content, buffers in customs if content.get("kind") == kind]

    def comm_messages(self) -> list[Message]:
        """The messages of the widget's comm."""
        return [
            m
            for m in self.kernel.messages[self.began :]
            if m["msg_type"] == "comm_msg" and m["content"]["comm_id"] == self.comm
        ]

    def still(self) -> dict[str, Any]:
        """What is saved in the notebook."""
        identity = self.first["transient"]["display_id"]
        updates = [
            m["content"]
            for m in self.kernel.messages
            if m["msg_type"] == "update_display_data" and m["content"]["transient"]["display_id"] == identity
        ]
        return dict([self.first, *updates][-1]["data"])
