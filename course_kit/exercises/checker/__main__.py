"""The checker's process, which serves until its connection is closed.

`python -I -m course_kit.exercises.checker FILE_DESCRIPTOR [FOLDER…]`: the connection is the file
descriptor's. The folders have modules of a sourced ROS 2.
"""

from __future__ import annotations

import os
import signal
import sys
from multiprocessing.connection import Connection


def main() -> None:
    """Serve. An interrupt is meant for the notebook's cell, not for this process."""
    sys.path += sys.argv[2:]
    signal.signal(signal.SIGINT, lambda *_: None)  # not SIG_IGN, which the programs that a check starts would inherit
    from course_kit.exercises.checker.server import Checker
    from course_kit.exercises.protocol.channel import Channel
    from course_kit.ros.spinning import action_answers

    action_answers.keep()
    channel = Channel(Connection(int(sys.argv[1])))
    Checker(channel).serve()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)  # everything has ended in good order; nothing in rclpy's exit may keep the process


if __name__ == "__main__":
    main()
