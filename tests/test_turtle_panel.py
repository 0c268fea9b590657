"""The turtle panel in a real kernel: what it sends, what it does when told to, what stays of it."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from tests.kernel import Kernel, Message, kernel_after
from tests.widget_cell import WIDGET, WidgetCell

SET_UP = """
import time
from course_kit import record, run, stop
from course_kit import drive
from course_kit import TurtleSim
from course_kit.ros.subscriptions import observer_node
turtlesim = run(TurtleSim)
"""
MIDDLE = 5.544444561004639


@pytest.fixture(scope="module")
def kernel() -> Iterator[Kernel]:
    with kernel_after(SET_UP) as one:
        yield one


class Panel(WidgetCell):
    """drive() in a cell, with this test in the browser's place."""

    def __init__(self, kernel: Kernel, arguments: str = "") -> None:
        super().__init__(kernel, f"panel = drive({arguments})\npanel")


@pytest.fixture
def panel(kernel: Kernel) -> Iterator[Panel]:
    one = Panel(kernel)
    yield one
    kernel.run("panel.close()")


def pose(kernel: Kernel, turtle: str = "turtle1") -> list[float]:
    """Where the panel sees a turtle; nothing before it does."""
    seen = f"panel._topics.field.turtles.get('{turtle}')"
    return [*map(float, kernel.value(f"*getattr({seen}, 'pose', None) or ()").split())]


def until_it_rests(kernel: Kernel) -> None:
    """Wait until no command moves the turtle any more: one of an earlier test does so for a second."""
    kernel.until(lambda: kernel.value("getattr(panel._topics.field.turtles.get('turtle1'), 'rests', None)") == "True")


def image_of(png: bytes) -> Image.Image:
    return Image.open(io.BytesIO(png))


def test_its_end_leaves_a_picture_and_a_text_without_a_widget(kernel: Kernel) -> None:
    panel = Panel(kernel)
    kernel.until(lambda: pose(kernel))
    kernel.run("panel.close()")
    kernel.until(lambda: WIDGET not in panel.still())
    assert panel.still()["text/plain"].startswith("The turtles' field: turtle1 at (")
    field = image_of(base64.b64decode(panel.still()["image/png"]))
    assert field.size == (500, 500) and field.convert("RGB").getpixel((5, 5)) == (69, 86, 255)
    assert kernel.value("panel, panel.is_running") == "<turtles, stopped> False"


def test_a_browser_that_asks_gets_all_of_the_field(kernel: Kernel, panel: Panel) -> None:
    panel.tell(kind="call", service="reset")
    kernel.until(lambda: pose(kernel) == [MIDDLE, MIDDLE, 0.0])
    while (x := kernel.until(lambda: pose(kernel))[0]) < 6.2:  # a busy simulator moves it less far in its second
        panel.tell(kind="key", key="up")
        kernel.until(lambda: (now := pose(kernel)) and now[0] > x)
    before = len(panel.said("field"))
    panel.tell(kind="show")
    kernel.until(lambda: len(panel.said("field")) > before)
    content, (trails, shells) = panel.said("field")[-1]
    assert content["background"] == "rgb(69, 86, 255)"
    assert [turtle["name"] for turtle in content["turtles"]] == ["turtle1"]
    drawn = np.array(image_of(trails).convert("RGBA"))
    assert tuple(drawn[250, 270]) == (179, 184, 255, 255) and drawn[100, 270, 3] == 0
    assert image_of(shells).size == (8 * 120, 120)


def moves(panel: Panel) -> NDArray[np.float32]:
    """All moves that were sent, as rows: the turtle's number, x, y, heading."""
    return np.frombuffer(b"".join(moved for _, (moved,) in panel.said("moves")), np.float32).reshape(-1, 4)


def test_moves_are_sent_in_one_message_a_frame_and_none_is_lost(kernel: Kernel, panel: Panel) -> None:
    panel.tell(kind="spawn", x=3.0, y=3.0)
    kernel.until(lambda: pose(kernel, "turtle2"))
    until_it_rests(kernel)
    shown = len(panel.said("field"))
    panel.tell(kind="show")
    kernel.until(lambda: len(panel.said("field")) > shown)  # what was before is in there
    before = len(moves(panel))
    while (count := len(moves(panel))) < before + 40:  # a turn has 62 ticks, on a busy machine less
        panel.tell(kind="key", key="left")
        kernel.until(lambda: len(moves(panel)) > count)
    turned = moves(panel)[before:]
    assert len(np.unique(turned[:, 0])) == 1
    assert np.allclose(np.diff(np.unwrap(turned[:, 3])), 0.032, atol=1e-4)  # each tick's
    counts = [m["content"]["data"]["content"]["count"] for m in panel.comm_messages() if _is_counted(m)]
    assert counts == list(range(counts[0], counts[0] + len(counts)))


def _is_counted(message: Message) -> bool:
    return "count" in message["content"]["data"].get("content", {})


def test_a_click_teleports_and_spawns(kernel: Kernel, panel: Panel) -> None:
    until_it_rests(kernel)
    panel.tell(kind="teleport", x=2.0, y=9.0)
    kernel.until(lambda: pose(kernel)[:2] == [2.0, 9.0])
    count = int(kernel.value("len(panel._topics.field.turtles)"))
    panel.tell(kind="spawn", x=8.0, y=1.0)
    kernel.until(lambda: int(kernel.value("len(panel._topics.field.turtles)")) == count + 1)


def test_nothing_is_sent_while_nobody_looks_and_all_of_it_afterwards(kernel: Kernel) -> None:
    tab = "a browser tab"
    session, channel = kernel.client.session, kernel.client.shell_channel
    content = {"comm_id": tab, "target_name": "course_kit.views", "data": {"looks": False}}
    panel = Panel(kernel)
    kernel.until(lambda: panel.said("field"))
    channel.send(session.msg("comm_open", content))
    kernel.until(
        lambda: kernel.value("__import__('course_kit.views.live.tabs').views.live.tabs.somebody_looks()") == "False"
    )
    kernel.until(lambda: kernel.value("time.monotonic() - panel._shown_at > 1.0") == "True")  # so all is sent anew
    before = len(panel.said("moves")), len(panel.said("field"))
    panel.tell(kind="key", key="up")
    kernel.until(lambda: float(kernel.value("turtlesim.world.turtles['turtle1'].forward")) == 2.0)
    kernel.until(lambda: float(kernel.value("turtlesim.world.turtles['turtle1'].forward")) == 0.0)
    assert (len(panel.said("moves")), len(panel.said("field"))) == before
    channel.send(session.msg("comm_msg", {"comm_id": tab, "data": {"looks": True}}))
    kernel.until(lambda: len(panel.said("field")) > before[1])
    channel.send(session.msg("comm_close", {"comm_id": tab, "data": {}}))
    kernel.run("panel.close(); from course_kit.views.live import tabs; tabs._looking.clear()")


def test_keys_say_that_the_node_which_sends_them_was_stopped(kernel: Kernel, panel: Panel) -> None:
    kernel.run("stop(panel.teleop)")
    panel.tell(kind="key", key="up")
    kernel.until(lambda: panel.said("said"))
    assert panel.said("said")[-1][0]["text"] == (
        "Keys do nothing: the node /teleop_turtle, which sends them, was stopped. Run the panel's cell again."
    )


def test_a_service_that_nobody_offers_is_told(kernel: Kernel) -> None:
    panel = Panel(kernel, "namespace='nobody'")
    panel.tell(kind="call", service="reset")
    kernel.until(lambda: panel.said("said"))
    assert panel.said("said")[-1][0]["text"] == "nobody offers /nobody/reset (waited 1 s)"
    kernel.run("panel.close()")
    kernel.until(lambda: WIDGET not in panel.still())
    assert panel.still()["text/plain"] == "The turtles' field: no turtle; nothing is drawn."


def test_two_panels_drive_two_turtles(kernel: Kernel, panel: Panel) -> None:
    panel.tell(kind="spawn", x=3.0, y=3.0)
    kernel.until(lambda: "turtle2" in kernel.value("list(panel._topics.field.turtles)"))
    kernel.run("first = panel")
    other = Panel(kernel, "'turtle2'")
    panel.tell(kind="key", key="left")
    other.tell(kind="key", key="up")
    forward = "turtlesim.world.turtles['turtle2'].forward, turtlesim.world.turtles['turtle1'].turning"
    kernel.until(lambda: kernel.value(forward) == "2.0 2.0")
    kernel.run("panel.close(); panel = first")


def test_a_panel_that_cannot_go_on_is_said_to_stand_still(kernel: Kernel) -> None:
    panel = Panel(kernel)
    kernel.run("panel._topics.take = lambda: 1 / 0")
    kernel.until(lambda: "stands still: ZeroDivisionError: " in panel.still()["text/plain"])
    assert "Run its cell again to go on." in panel.still()["text/plain"]
    kernel.until(lambda: kernel.value("panel.is_running") == "False")
