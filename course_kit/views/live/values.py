"""Numbers of topics over time, drawn as they come."""

from __future__ import annotations

import base64
import io

from course_kit.base.arguments import SPAN, WAIT, takes
from course_kit.base.figures import COLOURS, SCREEN_DPI, Plot, style, widen
from course_kit.lab.series import field_paths, value_plots, value_series
from course_kit.views.live.shown import Bundle
from course_kit.views.live.view import LONGEST, LiveView

PERIOD = 0.5  # seconds between two pictures: one takes most of a tenth of a second of the processor
KEPT = 20_000  # messages of each topic
MOST = 1500  # of them in one picture


@takes(span=SPAN, period=SPAN, seconds=SPAN, timeout=WAIT)
def watch_values(
    *paths: str, span: float = 10.0, period: float = PERIOD, seconds: float = LONGEST, timeout: float = 10.0
) -> LiveView:
    """Draw numbers of topics over the last `span` seconds, live, one row a path: '/turtle1/pose.x'.

    Paths and errors are those of values(). It ends with .stop(), with the next run of its cell, or after `seconds`.
    """
    wanted = [field_paths.parse(path) for path in paths]
    if not wanted:
        raise TypeError("give paths of numbers, such as '/turtle1/pose.x'")
    recording = value_series.record_live(wanted, timeout, keep=KEPT)

    def draw() -> Bundle:
        now = recording.duration
        read = value_series.from_recording(wanted, recording, since=now - span, most=MOST)
        plot = Plot(8.4, 0.7 + 1.5 * len(read))
        rows = plot.subplots(len(read), 1, squeeze=False, sharex=True)[:, 0]
        for axes, colour, series in zip(rows, COLOURS * len(read), read.values(), strict=False):
            style(axes, title=series.path)
            value_plots.draw_series(axes, series, colour, series.start_ns)
            widen(axes)
            axes.set_xlim(max(0.0, now - span), max(span, now))  # the same width of time whatever came
        rows[-1].set_xlabel("time since the start [s]", fontsize=10)
        plot.description = value_plots.in_words(read.values())
        return _as_picture(plot)

    return LiveView("values", draw, recording.stop, period, seconds)


def _as_picture(figure: Plot) -> Bundle:
    """A figure as a picture, drawn at the size at which it is shown: a sharper one takes three times as long."""
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=SCREEN_DPI)
    return {"image/png": base64.b64encode(picture.getvalue()).decode(), "text/plain": repr(figure)}
