"""Answers to chapter 2's exercises: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises import workspace_batteries, workspace_greeters, workspace_patrols, workspace_rooms
from tests.exercises.workspace_cells import PREPARE

__all__ = ["ANSWERS", "PREPARE"]

CHAPTER = workspace_greeters, workspace_rooms, workspace_batteries, workspace_patrols
ANSWERS = [answers for module in CHAPTER for answers in module.ANSWERS]
