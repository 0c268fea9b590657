"""Chapter 4's exercises: a check each, and their worked solutions."""
