"""Chapter 1's exercises: a check each, and their worked solutions."""
