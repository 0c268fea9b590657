"""Chapter 2's exercises: a check each, and their worked solutions."""
