"""Scans, maps, paths and poses in one frame, drawn as rviz2 does."""
