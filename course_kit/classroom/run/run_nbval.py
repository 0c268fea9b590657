"""`python -I -m course_kit.classroom.run.run_nbval FOLDER… -- ARGUMENT…`: pytest with these arguments.

The folders have modules of a sourced ROS 2, which an isolated Python does not find by itself.
"""

from __future__ import annotations

import sys


def main() -> int:
    """Run pytest; return its exit status."""
    end = sys.argv.index("--")
    sys.path += sys.argv[1:end]
    import pytest

    return int(pytest.main(sys.argv[end + 1 :]))


if __name__ == "__main__":
    raise SystemExit(main())
