"""rclpy and DDS from below: their private parts, spinning, subscriptions, the graph, and the causes of errors.

It asks base.
"""
