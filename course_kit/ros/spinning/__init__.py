"""The ROS context of this process, executors in threads, and what their callbacks raise."""


class NodeAlreadyRuns(RuntimeError):  # noqa: N818  (reads as what happened)
    """Something tried to spin a node that already runs in the background."""


class BlockingWait(RuntimeError):  # noqa: N818
    """A callback tried to wait for something that only its own executor could deliver."""


class NodeStopped(BaseException):
    """Raised inside a callback that still runs when its node is stopped."""
