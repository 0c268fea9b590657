"""What the course shows inside a notebook: the only part of course_kit that imports Jupyter."""
