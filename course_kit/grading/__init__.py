"""A class graded: from the students' edition over what was handed in to the gradebook, each student in a sandbox."""
