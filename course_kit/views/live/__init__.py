"""The live views of a notebook: the only part of course_kit that imports Jupyter, beside check() and `%ros2`."""
