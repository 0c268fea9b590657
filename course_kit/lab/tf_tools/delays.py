"""Delays and rates of transforms, as tf2_monitor prints them. Pure, no ROS."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

KEPT = 1000  # of each frame
BROADCASTER = "<no authority available>"  # ROS 2 does not tell tf2 who has sent a transform
LOW_PASS = 0.01


def _kept() -> deque[float]:
    return deque(maxlen=KEPT)


class Delays:
    """Counts messages of transforms, as they come; all times in seconds."""

    def __init__(self) -> None:
        self._frames: dict[str, deque[float]] = {}
        self._messages, self._arrivals = _kept(), _kept()

    def take(self, stamps: Sequence[tuple[str, float]], now: float) -> None:
        """One message: the child frame and the stamp of each of its transforms, and when it came."""
        delays = [now - stamp for _, stamp in stamps]
        for (frame, _), delay in zip(stamps, delays, strict=True):
            self._frames.setdefault(frame, _kept()).append(delay)
        self._messages.append(sum(delays) / max(1, len(delays)))
        self._arrivals.append(now)

    def frame_lines(self, within: Sequence[str] | None = None) -> list[str]:
        """A line for each frame that has come, or for those of them that are in a chain."""
        return [
            f"Frame: {frame}, published by {BROADCASTER}, Average Delay: {_mean(of_frame):g}, "
            f"Max Delay: {_longest(of_frame):g}"
            for frame, of_frame in sorted(self._frames.items())
            if within is None or frame in within
        ]

    def broadcaster_lines(self) -> list[str]:
        """A line for all that broadcast, as soon as anything has come."""
        if not self._arrivals:
            return []
        rate = len(self._arrivals) / max(1e-8, self._arrivals[-1] - self._arrivals[0])
        return [
            f"Node: {BROADCASTER} {rate:g} Hz, Average Delay: {_mean(self._messages):g} "
            f"Max Delay: {_longest(self._messages):g}"
        ]


class ChainDelay:
    """How old the transform between two frames is, each time that it is looked at."""

    def __init__(self) -> None:
        self.average = self.longest = 0.0

    def take(self, delay: float) -> None:
        """One look; the average follows slowly, as that of the real tool."""
        self.average += LOW_PASS * (delay - self.average)
        self.longest = max(self.longest, delay)


def results(delays: Delays, frames: tuple[str, str] | None, chain: Sequence[str], of_chain: ChainDelay) -> list[str]:
    """What is printed every ten seconds: of two frames and what lies between them, or of all that come.

    The chain is whole, where that of the real tool lacks frames if the way leads up a tree.
    """
    heading = ["RESULTS: for all Frames"]
    if frames is not None:
        heading = [
            f"RESULTS: for {frames[0]} to {frames[1]}",
            f"Chain is: {' -> '.join(chain)}",
            f"Net delay     avg = {of_chain.average:g}: max = {of_chain.longest:g}",
        ]
    of_frames = delays.frame_lines(None if frames is None else chain)
    return ["", "", "", *heading, "", "Frames:", *of_frames, "", "All Broadcasters:", *delays.broadcaster_lines()]


def _mean(values: Sequence[float] | deque[float]) -> float:
    return sum(values) / len(values)


def _longest(values: Sequence[float] | deque[float]) -> float:
    return max(0.0, *values)
