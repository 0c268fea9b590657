"""Every option of `ros2` that takes a number, with what is none."""

from __future__ import annotations

import itertools

from tests.ros2_bad_calls.call import TWIST, Bad

NUMBERS = ("", "nan", "inf", "-inf", "1e400", "-1", "<1e23>", "five", "½", "<long>")
NUMBER_OPTIONS = (
    "topic hz /turtle1/pose --duration",
    "topic bw /turtle1/pose --duration",
    "topic delay /turtle1/pose --duration",
    "topic echo /turtle1/pose --duration",
    f"{TWIST} --duration",
    "bag record --all --duration",
    "bag play <folder> --duration",
    "run --duration",
    "launch --duration",
    "doctor hello --duration",
    "doctor hello --emit-period",
    "doctor hello --print-period",
    "doctor hello --ttl",
    "lifecycle get /turtlesim --timeout",
    "lifecycle list /turtlesim --timeout",
    "lifecycle set /turtlesim configure --timeout",
    "lifecycle nodes --spin-time",
    "topic list --spin-time",
    "service list --spin-time",
    "action list --spin-time",
    "node list --spin-time",
    "param list --spin-time",
    "param list --timeout",
    "topic echo /turtle1/pose --timeout",
    "topic echo /turtle1/pose --truncate-length",
    "service echo /spawn --truncate-length",
    "service echo /spawn --duration",
    f"{TWIST} --rate",
    f"{TWIST} --keep-alive",
    f"{TWIST} --max-wait-time-secs",
    f"{TWIST} --times",
    f"{TWIST} --wait-matching-subscriptions",
    f"{TWIST} --print",
    "topic hz /turtle1/pose --window",
    "topic bw /turtle1/pose --window",
    "topic delay /turtle1/pose --window",
    "bag play <folder> --rate",
    "bag play <folder> --clock",
    "bag play <folder> --delay",
    "bag play <folder> --start-offset",
    "bag play <folder> --read-ahead-queue-size",
    "bag play <folder> --wait-for-all-acked",
    "bag record --all --polling-interval",
    "bag record --all --max-bag-size",
    "bag record --all --max-bag-duration",
    "bag record --all --max-cache-size",
    "pkg create new --package-format",
)
# Where -1 has a meaning, or is refused in other words.
ALSO_NEGATIVE = (
    "topic echo /turtle1/pose --qos-depth",
    "topic echo /turtle1/pose --qos-liveliness-lease-duration-seconds",
    f"{TWIST} --qos-depth",
    f"{TWIST} --qos-liveliness-lease-duration-seconds",
    "bag play <folder> --playback-duration",
    "bag play <folder> --playback-until-sec",
    "bag play <folder> --playback-until-nsec",
    "service call /clear std_srvs/srv/Empty --rate",
)


def numbers() -> list[Bad]:
    """Every option that takes a number, with what is none, or none that it can be."""
    calls = [
        *itertools.product(NUMBER_OPTIONS, NUMBERS),
        *itertools.product(ALSO_NEGATIVE, [number for number in NUMBERS if number != "-1"]),
    ]
    return [
        Bad(f"{option}='{number}'", rf"error: argument .*{option.split()[-1]}\b.*: .", 2) for option, number in calls
    ]
