"""The alternative text of pictures: what it says of their data, and where a notebook keeps it."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path as File
from typing import Any
from urllib.request import urlopen

import nbformat
import pytest
from bs4 import BeautifulSoup
from geometry_msgs.msg import PoseStamped
from matplotlib.figure import Figure
from nav_msgs.msg import OccupancyGrid, Path
from nbformat.v4 import new_code_cell, new_notebook, new_output
from rclpy.serialization import serialize_message
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Header
from turtlesim.msg import Pose

from course_kit.base.alternative_text import of_figure, span
from course_kit.base.figures import Plot, style
from course_kit.classroom.report import feedback_plots
from course_kit.lab.calls.goal_plots import CHANGES, plot_goal_states
from course_kit.lab.recordings.buffers import MessageBuffer
from course_kit.lab.recordings.plots import plot_pose, plot_rates
from course_kit.lab.recordings.topic_recording import TopicRecording
from course_kit.lab.scene.scene_plots import plot_scene
from course_kit.lab.series.value_plots import plot_values
from course_kit.lab.series.value_series import values
from course_kit.robots.turtlesim import picture
from course_kit.robots.turtlesim.world import World
from course_kit.ros.graph.plots import draw_graph
from course_kit.ros.graph.snapshot import Channel, Endpoint, GraphNode, Parameter, Qos, Snapshot
from tests.kernel import Kernel
from tests.lab import server

MS = 1_000_000  # nanoseconds


def recording(poses: list[Pose], period_ms: int = 100) -> TopicRecording:
    buffer = MessageBuffer(["/turtle1/pose"])
    append = buffer.appender("/turtle1/pose")
    for number, pose in enumerate(poses):
        append(serialize_message(pose), number * period_ms * MS)
    return TopicRecording("/turtle1/pose", Pose, buffer.snapshot("/turtle1/pose"), 0)


STRAIGHT = [Pose(x=5.0 + 0.1 * step, y=5.0, linear_velocity=1.0) for step in range(21)]


def test_a_path_is_told_by_its_ends_its_length_and_its_velocities() -> None:
    told = repr(plot_pose(recording(STRAIGHT), title="Driven by hand", goals=[(7.0, 5.0)]))
    assert told == (
        "Driven by hand. Path of /turtle1/pose: 2.0 s; from (5.00, 5.00) m to (7.00, 5.00) m; 2.00 m long; "
        "x from 5 to 7 m, y 5 m; heading 0.00 rad at the start and 0.00 rad at the end; "
        "linear velocity 1 m/s, angular velocity 0 rad/s. Goals: (7.00, 5.00) m."
    )


def test_a_jump_is_told_and_not_counted_as_a_way() -> None:
    told = repr(plot_pose(recording([*STRAIGHT, Pose(x=1.0, y=9.0, linear_velocity=1.0)])))
    assert "to (1.00, 9.00) m; 2.00 m long with 1 jump;" in told


def test_rates_are_told_with_their_periods() -> None:
    assert repr(plot_rates(recording(STRAIGHT))) == (
        "Rates and periods. /turtle1/pose: 21 messages in 2.0 s, mean 10 Hz, over time 10 Hz; "
        "periods: median 100 ms, 99 % within 100 ms, longest 100 ms."
    )


def test_values_are_told_with_their_first_last_and_extreme_ones() -> None:
    assert repr(plot_values(values("/turtle1/pose.x", source=recording(STRAIGHT)))) == (
        "/turtle1/pose.x: 21 messages from 0.0 s to 2.0 s, from 5 to 7, at first 5, at last 7."
    )


def test_a_graph_is_told_with_who_is_on_which_side_and_what_does_not_match() -> None:
    scan, text, empty = "sensor_msgs/msg/LaserScan", "std_msgs/msg/String", "std_srvs/srv/Empty"
    laser = GraphNode("/laser", parameters=(Parameter("rate", "double", "10.0"),))
    shown = Snapshot(
        (laser, GraphNode("/wanderer"), GraphNode("/a")),
        (
            Channel("topic", "/chatter", (Endpoint("/a", text),)),
            Channel("topic", "/scan", (Endpoint("/laser", scan, Qos("best_effort")),), (Endpoint("/wanderer", scan),)),
            Channel("service", "/reset", (Endpoint("/a", empty),), (Endpoint("/laser", empty),)),
        ),
    )  # fmt: skip
    assert repr(draw_graph(shown)) == (
        "3 nodes, 2 topics, 1 service  ·  1 with ends that do not match. Nodes: /laser (rate = 10.0), /wanderer, /a. "
        "Topic /chatter (std_msgs/msg/String, reliable): published by /a, subscribed by nobody. "
        "Topic /scan (sensor_msgs/msg/LaserScan, best effort / reliable): published by /laser, subscribed by /wanderer."
        " Does not match: reliable subscription, best-effort publisher: nothing arrives. "
        "Service /reset (std_srvs/srv/Empty): called by /a, served by /laser."
    )
    assert repr(draw_graph(Snapshot())) == "No node runs in this domain."


def test_a_scene_is_told_layer_by_layer() -> None:
    header = Header(frame_id="map")
    grid = OccupancyGrid(header=header, data=[0, 100, -1, 0])
    grid.info.width, grid.info.height, grid.info.resolution = 2, 2, 0.5
    path = Path(header=header, poses=[PoseStamped(header=header) for _ in range(2)])
    path.poses[1].pose.position.x = 3.0
    scan = LaserScan(header=header, angle_increment=math.pi / 2, range_max=9.0, ranges=[1.0, 2.0])
    assert repr(plot_scene(grid, path, scan=scan)) == (
        "Seen from above, in frame 'map'. OccupancyGrid: a map of 2 by 2 cells of 0.5 m, x from 0 to 1 m, "
        "y from 0 to 1 m, 25 % occupied, 50 % free, the rest unknown. "
        "Path: a path from (0.00, 0.00) m to (3.00, 0.00) m, 3.00 m long. "
        "scan: a scan with 2 hits, from 1 to 2 m away. "
        "Frame 'map' is at (0.00, 0.00) m, turned by 0.00 rad."
    )


def test_the_states_of_a_goal_are_told_with_all_changes() -> None:
    told = repr(plot_goal_states())
    assert all(f"{start} to {end} by {call} of the " in told for start, end, call, _, _ in CHANGES)


def test_the_turtles_field_is_told_with_turtles_and_trails() -> None:
    world = World(0)
    assert picture.draw(world.scene(), (69, 86, 255)).info["Description"] == (
        "The turtles' field: turtle1 at (5.54, 5.54) m, heading 0.00 rad; nothing is drawn."
    )
    world.turtles["turtle1"].forward = 1.0
    for tick in range(100):
        world.tick(tick * 16 * MS)
    small = picture.draw(world.scene(), (69, 86, 255)).resize((200, 200))
    assert "trails lie between (5.5" in small.info["Description"]


def test_a_class_is_told_in_numbers() -> None:
    assert "0 to 10 %: 1, 90 to 100 %: 2." in feedback_plots.spread([0.0, 95.0, 100.0])
    assert "hardest first. a &lt;b&gt;: 20 %, c: 90 %." in feedback_plots.shares([("a <b>", 20.0), ("c", 90.0)])


@pytest.mark.parametrize("text", ["a title", ""])
def test_a_figure_that_nobody_has_described_is_told_by_what_is_drawn_in_it(text: str) -> None:
    plot = Plot(4, 3, text or None)
    axes = style(plot.subplots(), "time [s]", "speed [m/s]", "how fast")
    axes.plot([0, 1, 2], [0.5, 3.0, math.nan], label="turtle1")
    axes.eventplot([0.25, 1.5])
    axes.axvspan(0.5, 1.0)
    axes.set_yticks([0, 3], ["stands", "drives"])
    told = (
        "how fast, x is time [s] and y is speed [m/s], y 0 is stands, y 3 is drives, turtle1 with 3 points: x from 0 "
        "to 2, y from 0.5 to 3, 1 area, x from 0.5 to 1, 2 marks, x from 0.25 to 1.5."
    )
    assert repr(plot) == (f"a title. {told}" if text else told)


def test_a_span_names_no_rest_of_a_zero_and_no_missing_number() -> None:
    assert span([-1.5e-6, 9.3, math.nan], "rad/s") == "from 0 to 9.3 rad/s"
    assert (span([2.0, 2.0], "m"), span([0.0]), span([math.nan])) == ("2 m", "0", "no number")


def test_an_empty_figure_and_bars_are_told() -> None:
    assert of_figure(Figure()) == "An empty figure."
    figure = Figure()
    figure.add_subplot().bar(["reliable", "best effort"], [50, 31])
    assert of_figure(figure) == "A plot, x 0 is reliable, x 1 is best effort, 2 bars, length from 31 to 50."


SHOWN = {
    "a plot of the course": ("from course_kit.base.figures import Plot\nplot = Plot(2, 1, 'one')\nplot", "one."),
    "a plot after pyplot": (
        "import matplotlib.pyplot as plt\nplot = Plot(2, 1, 'one')\nplot.subplots().plot([1, 2])\nplot",
        "one. A plot, a line with 2 points: x from 0 to 1, y from 1 to 2.",
    ),
    "pyplot's own": ("plt.plot([1, 2])\nplt.show()", "A plot, a line with 2 points: x from 0 to 1, y from 1 to 2."),
    "an image": (
        "from PIL import Image\nimage = Image.new('RGB', (9, 9))\nimage.info['Description'] = 'dark'\nimage",
        "dark",
    ),
}


@pytest.fixture(scope="module")
def kernel():
    kernel = Kernel()
    kernel.run("from course_kit.base.figures import Plot")
    yield kernel
    kernel.close()


@pytest.mark.parametrize("name", SHOWN)
def test_a_cells_picture_has_its_text_as_plain_text_and_as_metadata(kernel: Kernel, name: str) -> None:
    code, text = SHOWN[name]
    shown: list[Any] = [
        message["content"]
        for message in kernel.of(kernel.run("import matplotlib.pyplot as plt\n" * (name == "pyplot's own") + code))
        if message["msg_type"] in ("display_data", "execute_result")
    ]
    assert [one["data"]["text/plain"] for one in shown] == [text]
    assert shown[0]["metadata"]["image/png"]["alt"] == text


@pytest.mark.parametrize("app", ["nbconvert", "server"])
def test_exported_html_has_it(app: str, tmp_path: File) -> None:
    """By `jupyter nbconvert`, and by what JupyterLab's menu asks its server for."""
    picture = new_output(
        "display_data",
        {"image/png": "iVBORw0KGgo=", "text/plain": "dark"},
        metadata={"image/png": {"width": 9, "alt": 'a "dark" <room>'}},
    )
    nbformat.write(new_notebook(cells=[new_code_cell("image", outputs=[picture])]), tmp_path / "room.ipynb")
    if app == "nbconvert":
        command = [sys.executable, "-m", "jupyter", "nbconvert", "--to", "html", str(tmp_path / "room.ipynb")]
        subprocess.run(command, check=True, capture_output=True, timeout=110)
        page = (tmp_path / "room.html").read_text()
    else:
        with (
            server(tmp_path, tmp_path / "config") as address,
            urlopen(address.replace("/lab?", "/nbconvert/html/room.ipynb?"), timeout=60) as answer,
        ):
            page = answer.read().decode()
    (image,) = BeautifulSoup(page, "html.parser").select("main img")
    assert (image["alt"], image["width"]) == ('a "dark" <room>', "9")
