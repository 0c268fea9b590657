"""A class run: each notebook in a sandbox, with a checker of the grader."""
