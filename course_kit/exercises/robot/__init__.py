"""Chapter 7's exercises: a check each, and their worked solutions."""
