"""The programs of the patrol robot. Plain rclpy: they know nothing of this course."""
