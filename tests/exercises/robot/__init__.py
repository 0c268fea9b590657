"""Answers to the exercises of chapter 7: right ones in several styles, and wrong ones that students give."""
