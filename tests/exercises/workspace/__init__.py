"""Answers to the exercises of chapter 2: right ones in several styles, and wrong ones that students give."""

from tests.exercises.workspace.cells import PREPARE as PREPARE
