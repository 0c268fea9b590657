"""Measures the course against plain rclpy: `python -m tests.benchmark [section ...] [--quick]`."""
