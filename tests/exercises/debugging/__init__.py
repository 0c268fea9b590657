"""Answers to the exercises of chapter 6: right ones in several styles, and wrong ones that students give."""
