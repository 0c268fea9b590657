"""The two simulators that the checks of chapter 1 watch: names and topics."""

from __future__ import annotations

FIRST, SECOND = "/turtlesim", "/robot2/turtlesim"
FIRST_POSE, FIRST_COMMANDS, SECOND_POSE = "/turtle1/pose", "/turtle1/cmd_vel", "/robot2/turtle1/pose"
STANDS = 0.05  # metres
SINCE = "It looks on from the first check in this notebook on"
