"""How a process ends in time, and what is left in shared memory by those that were killed."""
