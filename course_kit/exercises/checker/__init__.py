"""What a check of an exercise is made of: stations, the answer's host, verdict, and the vocabulary it is written in.

The checker is a process of its own with its own ROS contexts: one in the student's domain, one on the *stage*, a
domain in which only the student's class and what its exercise is about meet. It looks at nodes from outside, as a
robot would: graph, messages, answers, times.

What is trusted. The notebook's process only obeys: makes a node of the student's class on the stage, calls a method,
reads an attribute. What it says in return counts where the exercise is about exactly that: a value handed to check(),
what a method returns, what an attribute holds. All else is judged by traffic that a patched notebook can only produce
by doing what the exercise asks. That traffic counts only from the participant in which the answer is made (by the ids
of Fast DDS), and what a check tries is drawn from a seed that nobody knows before. The hints may quote errors that the
notebook reports; they give and cost no points.
"""
