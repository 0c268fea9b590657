"""How true the numbers of rates() are at high rates."""

from __future__ import annotations

import statistics
from collections.abc import Iterator

from tests.benchmark.child import Program
from tests.benchmark.table import Row
from tests.domains import reserve_domain

NOTE = (
    "rates: another process publishes serialised messages at a steady rate; in the second column the rate that it "
    "kept, in the third what rates() says."
)
TOLERANCE = 0.01
KINDS = {"String": "string", "LaserScan(360)": "scan"}


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    seconds = 1.0 if quick else 3.0
    with Program("rate_meter", domain=reserve_domain()) as meter:
        meter.report()
        for name, kind in KINDS.items():
            for rate in (5_000, 10_000, 15_000):
                reports = []
                for _ in range(1 if quick else 5):
                    meter.tell(f"measure {kind} {rate} {seconds}")
                    reports.append(meter.report(seconds + 60))
                reports.sort(key=lambda r: r["measured"] / r["really"])
                middle = reports[len(reports) // 2]
                worst = max(abs(r["measured"] / r["really"] - 1) for r in reports)
                yield Row(
                    f"rates() of {name} at {rate:,} a second",
                    "Hz",
                    middle["really"],
                    middle["measured"],
                    f"within {TOLERANCE:.0%}",
                    worst <= TOLERANCE,
                )
                lost = statistics.median(r["lost"] for r in reports)
                yield Row(f"rates() of {name} at {rate:,} a second: lost", "messages", None, lost)
