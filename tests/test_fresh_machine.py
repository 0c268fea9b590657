"""Set-up and chapters on bare Debian and Ubuntu, as an ordinary user, with what the script asks for.

A root file system is made by mmdebstrap for each release: there is no compiler in it, no ROS, no browser.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path

import psutil  # type: ignore[import-untyped]
import pytest

from tests.course_copy import CourseCopy
from tests.test_notebooks import NBVAL

PACKAGES = "apt,python3,python3-venv,python3-dev"  # what environment-check.sh names, and apt
STORE = Path("/etc/ssl/certs/ca-certificates.crt")
NEEDS = ("mmdebstrap", "unshare", "ip")
DEBIAN = "http://deb.debian.org/debian"
RELEASES = {
    "bookworm": [DEBIAN],
    "trixie": [DEBIAN],
    "noble": ["--components=main,universe", "http://archive.ubuntu.com/ubuntu"],
    # With the newest Python. A mirror may keep a state of it for longer than that state is valid.
    "forky": ['--aptopt=Acquire::Check-Valid-Until "false"', DEBIAN],
}
CHAPTERS = ("01_setup_checks", "02_workspace", "07_robot")
KEYS = {"noble": Path("/usr/share/keyrings/ubuntu-archive-keyring.gpg")}
# What a user would have been told about the network that this machine is in.
OF_THE_NETWORK = ("_PROXY", "_proxy", "SSL_CERT_FILE", "PIP_CERT", "INDEX_URL", "UV_INDEX", "UV_DEFAULT_INDEX")
# The view of the machine's processes is its own, and so is its shared memory.
ENTER = """
set -e
mount -t proc proc "$1/proc"
mount --rbind /dev "$1/dev"
mount -t tmpfs tmpfs "$1/dev/shm"
[ "$2" = network ] || ip link set lo up
root=$1
shift 2
exec chroot "$root" setpriv --reuid student --regid student --clear-groups -- "$@"
"""
# An exception of Fast CDR passes through a compiled library; one with another C++ library in it would not let it pass.
CUT_SHORT = """
from rclpy.serialization import deserialize_message, serialize_message
from turtlesim.srv import Spawn
request = Spawn.Request(name="a long name for a turtle")
written = serialize_message(request)
print(deserialize_message(written, Spawn.Request) == request)
try:
    deserialize_message(written[:-20], Spawn.Request)
except Exception as error:
    print(type(error).__name__)
"""

pytestmark = [
    pytest.mark.cpu_bound,
    pytest.mark.slow("a system, an environment and a workspace are made anew for each release"),
    pytest.mark.timeout(900),
    pytest.mark.skipif(os.geteuid() != 0, reason="only root can make a root file system"),
    pytest.mark.skipif(not all(map(shutil.which, NEEDS)), reason="needs the commands " + ", ".join(NEEDS)),
]


class Machine:
    """A bare system with the course in the home of a user who is not root."""

    def __init__(self, folder: Path, release: str) -> None:
        self.root = folder / "root"
        keys = [f"--keyring={KEYS[release]}"] if release in KEYS else []
        *options, mirror = RELEASES[release]
        user = 'chroot "$1" useradd --create-home student'
        make = ["mmdebstrap", "--quiet", "--variant=minbase", f"--include={PACKAGES}", f"--customize-hook={user}"]
        subprocess.run([*make, *keys, *options, release, self.root, mirror], check=True, timeout=600)
        for known in (Path("/etc/resolv.conf"), STORE):
            if known.exists():
                (self.root / known.relative_to("/")).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(known, self.root / known.relative_to("/"))
        self.course = CourseCopy(self.root / "home/student", name="course").root
        subprocess.run(["chroot", self.root, "chown", "-R", "student:", "/home/student"], check=True, timeout=60)

    def run(self, command: Sequence[str], network: bool = False, timeout: float = 600) -> subprocess.CompletedProcess:
        """Run a command in the course's folder, in an environment with nothing but what a login sets."""
        known = {name: text for name, text in os.environ.items() if any(word in name for word in OF_THE_NETWORK)}
        variables = {**known, "HOME": "/home/student", "PATH": "/usr/bin:/bin", "LANG": "C.UTF-8", "USER": "student"}
        inside = ["env", "-i", *(f"{name}={text}" for name, text in variables.items())]
        folder = str(Path("/") / self.course.relative_to(self.root))
        inside += ["sh", "-c", 'cd "$0" && exec "$@"', folder, *command]
        own = ["unshare", "--mount", "--pid", "--fork", "--kill-child", *([] if network else ["--net"])]
        enter = [*own, "sh", "-c", ENTER, "sh", str(self.root), "network" if network else "none"]
        with subprocess.Popen([*enter, *inside], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            try:
                said = process.communicate(timeout=timeout)
            finally:  # the first process of a namespace ends all others in it; its parent's end alone does not end it
                for first in psutil.Process(process.pid).children() if process.poll() is None else ():
                    first.kill()
        return subprocess.CompletedProcess(command, process.returncode, *said)


def releases() -> Iterator[object]:
    for release in RELEASES:
        yield pytest.param(release, marks=pytest.mark.xdist_group(f"bare {release}"))


@pytest.fixture(scope="module", params=list(releases()))
def machine(request, tmp_path_factory) -> Iterator[Machine]:
    if not KEYS.get(request.param, STORE.parent).exists():
        pytest.skip(f"the keys of {request.param} are not here: its keyring is not installed")
    machine = Machine(tmp_path_factory.mktemp("machine"), request.param)
    yield machine
    subprocess.run(["rm", "-rf", "--one-file-system", machine.root], check=True, timeout=300)


def test_the_script_asks_for_nothing_more_and_sets_up(machine):
    checked = machine.run(["./environment-check.sh"])
    assert ", 0 FAIL" in checked.stdout, checked.stdout + checked.stderr
    # nbval, which runs the chapters below, is no student's.
    done = machine.run(["./environment-check.sh", "lab", "--with-grading", "--version"], network=True)
    assert done.returncode == 0, done.stderr + (machine.course / "build/set-up.log").read_text()[-6000:]
    assert "Set up in " in done.stderr


def test_the_chapters_run_top_to_bottom(machine):
    for chapter in CHAPTERS:
        done = machine.run([".venv/bin/python", *NBVAL[1:], f"notebooks/{chapter}.ipynb"])
        assert done.returncode == 0, chapter + done.stdout[-6000:] + done.stderr[-2000:]


def test_help_has_no_colours(machine):
    """Python 3.14 colours that of argparse; FORCE_COLOR stands for a terminal."""
    for words in ([], ["topic"], ["topic", "echo"]):
        done = machine.run(["env", "FORCE_COLOR=1", ".venv/bin/ros2", *words, "--help"])
        assert done.stdout.startswith("usage: ros2"), done.stdout + done.stderr


def test_what_the_wheel_s_compiler_links_uses_the_libstdcxx_of_ros_2(machine):
    done = machine.run([".venv/bin/python", "-c", CUT_SHORT])
    assert done.stdout.split() == ["True", "RMWError"], done.stdout + done.stderr
    assert not list((machine.root / "home/student").rglob("libc++*.a"))  # zig's own takes a minute to compile
