"""A program with one plain rclpy node, for tests: `python plain_node.py NAME [services] [busy]`.

It logs at every level 20 times a second. With `services` its log level can be changed from outside; with `busy` its
timer computes for half of each tenth of a second.
"""

from __future__ import annotations

import sys
import time


def main(name: str, *options: str) -> None:
    import rclpy
    from rclpy.executors import ExternalShutdownException

    rclpy.init()
    node = rclpy.create_node(name, namespace="/robot", enable_logger_service="services" in options)
    logger = node.get_logger()

    def tick() -> None:
        logger.debug("a detail")
        logger.info("a fact")
        logger.warn("two\nlines")

    def compute() -> None:
        start = time.thread_time()
        while time.thread_time() - start < 0.05:
            pass

    node.create_timer(0.05, tick)
    if "busy" in options:
        node.create_timer(0.1, compute)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main(*sys.argv[1:])
