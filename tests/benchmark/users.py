"""Eight users of one machine start and end ROS again and again: how often they meet in shared memory.

Only root can be several users. They have a /dev/shm and a loopback interface of their own.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from tests.benchmark.child import PROFILES, ROOT
from tests.benchmark.table import Row, at_least, at_most
from tests.other_users import another_machine, command_of

NOTE = (
    "users: eight ordinary users, four of whom prefer the domains of the other four, in kernels, `ros2` verbs and "
    "launches at once; every kernel is killed. Plain is the course's profile with Fast DDS's own port base."
)
USERS = (3040, 3041, 3042, 3043, 3140, 3141, 3142, 3143)
PROGRAM = "tests.benchmark.programs.one_of_users"
LAUNCH = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

def generate_launch_description():
    node = Node(package="turtlesim", executable="turtlesim_node", namespace=LaunchConfiguration("name"))
    return LaunchDescription([DeclareLaunchArgument("name"), node])
"""


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this section."""
    if os.getuid() != 0:
        print("users: left out, only root can be several users", file=sys.stderr)
        return
    seconds = 30.0 if quick else 120.0
    met: dict[bool, dict[str, set[int]]] = {True: {}, False: {}}
    found = {shared: lived(seconds, shared, met[shared]) for shared in met}
    ports = {shared: sum(len(owners) > 1 for owners in met[shared].values()) for shared in met}
    counts = {
        shared: {key: sum(len(one[key]) for one in all_of_them) for key in ("lost", "strangers", "complaints")}
        for shared, all_of_them in found.items()
    }
    plain, course = counts[True], counts[False]
    rounds = {shared: sum(one["rounds"] for one in all_of_them) for shared, all_of_them in found.items()}
    yield at_least("8 users: rounds of a kernel, 4 verbs and a launch", "", rounds[False], len(USERS), rounds[True])
    yield at_most("8 users: ports in shared memory that two users had", "", ports[False], 0, ports[True])
    yield at_most("8 users: errors of Fast DDS's shared memory", "lines", course["complaints"], 0, plain["complaints"])
    yield at_most("8 users: messages and nodes of one's own that were lost", "", course["lost"], 0, plain["lost"])
    yield at_most("8 users: nodes of strangers that were seen", "", course["strangers"], 0, plain["strangers"])


def lived(seconds: float, shared: bool, owners: dict[str, set[int]]) -> list[dict[str, Any]]:
    """Return each user's report; with one port base for all of them, or each with their own.

    `owners` gets the users that each port in shared memory had.
    """
    with tempfile.TemporaryDirectory(prefix="course-users-", dir="/tmp") as made, another_machine() as machine:
        folder = Path(made)
        folder.chmod(0o755)
        (folder / "turtle.launch.py").write_text(LAUNCH)
        environment = {"PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1"}
        if shared:
            text = re.sub("<port>.*</port>", "", PROFILES["course"].read_text(), flags=re.DOTALL)
            (folder / "shared.xml").write_text(text)
            environment["FASTRTPS_DEFAULT_PROFILES_FILE"] = f"{folder}/shared.xml"
        running = []
        for user in USERS:
            home = folder / str(user)
            home.mkdir()
            os.chown(home, user, user)
            words = [sys.executable, "-m", PROGRAM, f"user_{user}", str(seconds), str(folder / "turtle.launch.py")]
            own = {**environment, "HOME": str(home), "TMPDIR": str(home)}
            command = [*machine.prefix, *command_of(user, folder, *words, environment=own)]
            running.append(subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True))
        while any(process.poll() is None for process in running):
            for port in machine.shared_memory.glob("fastrtps_port*"):
                with suppress(OSError):  # it has gone
                    owners.setdefault(port.name, set()).add(port.stat().st_uid)
            time.sleep(0.1)
        reports = []
        for user, process in zip(USERS, running, strict=True):
            printed, errors = process.communicate()
            if process.returncode:
                raise RuntimeError(f"user {user} ended with {process.returncode}: {errors}")
            reports.append(json.loads(printed.splitlines()[-1]))
            for what in (*reports[-1]["lost"], *reports[-1]["strangers"], *reports[-1]["complaints"]):
                print(f"users: {'plain' if shared else 'course'}, {user}: {what}", file=sys.stderr)
    return reports
