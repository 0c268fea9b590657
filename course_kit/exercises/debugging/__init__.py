"""Chapter 6's exercises: a check each, and their worked solutions."""
