"""The notebook's half of the exercises: check() and solution(), the student's progress, the host of the answer."""
