"""The instructor's wing: from the students' edition over the hand-ins to the gradebook, each student in a sandbox.

It asks base, setup and exercises; nothing of lab, cli or views. No student's kernel loads it.
"""
