"""The exports that put a shell into the course's environment: printed for `eval`, by local_setup.sh.

python -m course_kit.setup.environment.exports
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterator, Mapping

from course_kit.setup.environment.activation import RESTARTED, activate

OF_THE_RESTART = ("LD_LIBRARY_PATH", RESTARTED)  # which the wheels make: the next Python needs none


def exports(environ: Mapping[str, str]) -> Iterator[str]:
    """One `export` line for each variable that is set of those that activation sets."""
    activated: dict[str, str] = {}
    activate(environ=activated)
    for name in (*activated, *OF_THE_RESTART):
        if name in environ:
            yield f"export {name}={shlex.quote(environ[name])}"


if __name__ == "__main__":
    print(*exports(os.environ), sep="\n")  # activation has completed it when this Python started
