"""The checker's half of the exercises: a process that judges a student's nodes from outside, as a robot would.

It has two ROS contexts of its own: one in the student's domain, and one in the *test domain*, in which only the
student's class and the nodes that its exercise needs meet. It judges the graph, messages, answers and times.

What is trusted. The notebook's process only obeys: it makes a node of the student's class in the test domain, calls a
method, reads an attribute. What it says in return counts where the exercise is about exactly that: a value handed to
check(), the result of a method, the value of an attribute. All else is judged by traffic that a patched notebook can
only produce by doing what the exercise asks. That traffic counts only from the participant in which the answer is made
(by the ids of Fast DDS), and a check draws its numbers from a seed that nobody knows before. The hints may quote errors
that the notebook reports; they give and cost no points.
"""
