"""Answers to chapter 5's exercises, and what of the chapter they need."""

from __future__ import annotations

from tests.exercises import (
    answers_actions_countdown,
    answers_actions_deadline,
    answers_actions_impatient,
    answers_actions_star,
    answers_actions_west,
)

CELLS = (
    "actions-what-parts",
    "actions-server-class",
    "actions-server-execute-method",
    "actions-server-destroy-method",
    "actions-client-class",
    "actions-cancel-class",
    "actions-cancel-execute",
    "actions-polygon-provide",
    "actions-polygon-node",
    "actions-polygon-pose",
    "actions-polygon-corners",
    "actions-polygon-drive",
    "actions-polygon-execute",
)
PREPARE = """
import math

from rclpy.action import GoalResponse

from course_kit import run, wait_for

PolygonServer.drive, PolygonServer.execute = drive, execute
"""

ANSWERS = [
    answers_actions_west.ANSWERS,
    answers_actions_countdown.ANSWERS,
    answers_actions_impatient.ANSWERS,
    answers_actions_deadline.ANSWERS,
    answers_actions_star.ANSWERS,
]
