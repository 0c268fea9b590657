"""Answers to the exercises of chapter 1: right ones in several styles, and wrong ones that students give."""
