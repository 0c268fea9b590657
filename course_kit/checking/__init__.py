"""The process that checks exercises, its face in the notebook, and your progress."""
