"""Answers to chapter 5's exercises, and what of the chapter they need."""

from __future__ import annotations

from tests.exercises import (
    answers_actions_countdown,
    answers_actions_deadline,
    answers_actions_impatient,
    answers_actions_star,
    answers_actions_west,
)

ANSWERS = [
    answers_actions_west.ANSWERS,
    answers_actions_countdown.ANSWERS,
    answers_actions_impatient.ANSWERS,
    answers_actions_deadline.ANSWERS,
    answers_actions_star.ANSWERS,
]
