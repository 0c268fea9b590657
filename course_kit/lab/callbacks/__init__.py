"""The callbacks of a node: in which group each is, what may run at the same time, and what ran when."""
