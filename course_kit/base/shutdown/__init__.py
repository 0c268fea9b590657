"""Ends a process in time, and removes the shared memory of processes that were killed."""
