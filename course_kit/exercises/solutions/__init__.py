"""The worked solutions, and how a student's answer differs from them."""
