"""Answers to the exercises of chapter 4: right ones in several styles, and wrong ones that students give."""
