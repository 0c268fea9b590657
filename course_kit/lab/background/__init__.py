"""Nodes in the background of a notebook: run and stop them, wait for them, set their log levels."""
