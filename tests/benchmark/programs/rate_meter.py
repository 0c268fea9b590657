"""Measures the rate of a topic of another process with rates(): the command is `measure string|scan RATE SECONDS`."""

from __future__ import annotations

import sys

from course_kit.lab.recordings.rates import rates
from tests.benchmark.programs.reporting import report
from tests.senders import Sender

TOPIC = "/measured"
DEPTH = 5000


def main() -> None:
    report(ready=True)
    for line in sys.stdin:
        _, kind, rate, seconds = line.split()
        # It publishes before rates() looks and after it is done.
        count = int(float(rate) * (float(seconds) + 3))
        with Sender(TOPIC, kind, rate=float(rate), count=count, depth=DEPTH) as sender:
            sender.go()
            reading = rates(TOPIC, seconds=float(seconds))[TOPIC]
            really = sender.result()["rate"]
        report(measured=reading.rate, really=really, lost=reading.lost, messages=reading.messages)


if __name__ == "__main__":
    main()
