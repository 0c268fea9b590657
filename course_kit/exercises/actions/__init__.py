"""Chapter 5's exercises: a check each, and their worked solutions."""
