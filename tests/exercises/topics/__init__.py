"""Answers to the exercises of chapter 3: right ones in several styles, and wrong ones that students give."""
