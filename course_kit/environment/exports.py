"""What a shell has to export to be in the course's environment: printed for `eval`, by local_setup.sh.

python -m course_kit.environment.exports
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator, Mapping

from course_kit.environment.activation import PROFILE_VARIABLES, RESTARTED

# The variables that activation sets, and those of the restart that the wheels make: the next Python needs none.
NAMES = (
    "AMENT_PREFIX_PATH",
    "CMAKE_GENERATOR",
    "CMAKE_PREFIX_PATH",
    "CMAKE_TOOLCHAIN_FILE",
    "COLCON_PYTHON_EXECUTABLE",
    "COURSE_KIT_PREFIX",
    "DIST_EXTRA_CONFIG",
    "LD_LIBRARY_PATH",
    "PATH",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_DOMAIN_ID",
    "ROS_PYTHON_CHECK_FIELDS",
    *PROFILE_VARIABLES,
    RESTARTED,
)


def exports(environ: Mapping[str, str]) -> Iterator[str]:
    """One `export` line for each variable that is set."""
    for name in NAMES:
        if name in environ:
            yield f"export {name}={shlex.quote(environ[name])}"


if __name__ == "__main__":
    print(*exports(os.environ), sep="\n")  # activation has completed it when this Python started
