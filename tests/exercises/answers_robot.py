"""Answers to chapter 7's exercises."""

from __future__ import annotations

from tests.exercises import (
    answers_robot_exam,
    answers_robot_frames,
    answers_robot_journey,
    answers_robot_maps,
    answers_robot_particles,
    answers_robot_paths,
    answers_robot_where,
)

ANSWERS = [
    *answers_robot_frames.ANSWERS,
    *answers_robot_maps.ANSWERS,
    answers_robot_where.ANSWERS,
    answers_robot_particles.ANSWERS,
    answers_robot_paths.ANSWERS,
    answers_robot_journey.ANSWERS,
    answers_robot_exam.ANSWERS,
]
