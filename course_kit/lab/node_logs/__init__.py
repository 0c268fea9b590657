"""Logs of nodes: lines as they arrive, rates by level, files."""
