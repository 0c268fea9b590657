"""Chapter 3's exercises: a check each, and their worked solutions."""
