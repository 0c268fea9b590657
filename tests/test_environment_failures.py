"""environment-check.sh lab where set-up fails: what failed, why, the cure and the log, in five lines."""

from __future__ import annotations

import os
import shutil
import socket
import ssl
import subprocess
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from subprocess import CompletedProcess

import psutil  # type: ignore[import-untyped]
import pytest

from course_kit.setup.environment import failure
from tests.course_copy import BASE_PYTHON, SET_UP, UV, CourseCopy, fresh_environ, needs_root, needs_uv
from tests.http_server import serving
from tests.terminal import CTRL_C, Terminal
from tests.waiting import wait_until

pytestmark = pytest.mark.by_turns("many nodes and programs")

STORE = "/etc/ssl/certs/ca-certificates.crt"
OF_THE_NETWORK = ("_PROXY", "_proxy", "SSL_CERT_", "_CA_BUNDLE", "PIP_", "UV_")


@pytest.fixture
def course(tmp_path) -> CourseCopy:
    return CourseCopy(tmp_path, parts=SET_UP)


@pytest.fixture(scope="module")
def quick_python(tmp_path_factory) -> str:
    """The tests' Python, which copies the environment that it has made once, to be quick."""
    folder = tmp_path_factory.mktemp("python")
    subprocess.run([BASE_PYTHON, "-m", "venv", folder / "venv"], check=True, timeout=100)
    python = folder / "python3"
    copy = f"exec cp -r '{folder}/venv/.' \"$3\""
    python.write_text(f'#!/bin/sh\n[ "$1 $2" = "-m venv" ] && {copy}\nexec "{BASE_PYTHON}" "$@"\n')
    python.chmod(0o755)
    return str(python)


@pytest.fixture
def lab(course, quick_python) -> Callable[..., CompletedProcess[str]]:
    """A function that sets up in the terminal of a user who has told neither pip nor uv anything, and these variables.

    uv tries nothing again, to be quick. What is in the folder commands comes first on PATH.
    """
    kept = {name: value for name, value in fresh_environ().items() if not any(word in name for word in OF_THE_NETWORK)}
    path = [str(course.root.parent / "commands"), *(p for p in kept["PATH"].split(":") if not Path(p, "uv").exists())]
    quick = {"UV_HTTP_RETRIES": "0", "UV_NO_CACHE": "1", "PIP_NO_CACHE_DIR": "1", "PIP_CONFIG_FILE": os.devnull}

    def run(view: str = "", **variables: str) -> CompletedProcess[str]:
        environ = {**kept, **quick, "PYTHON": quick_python, "PATH": ":".join(path), **variables}
        return course.run("lab", environ=environ, view=view)

    return run


def test_in_a_terminal_a_step_counts_its_seconds_and_an_interrupt_leaves_nothing(course, quick_python, tmp_path):
    slow, begun = tmp_path / "slow", tmp_path / "begun"
    slow.write_text(f'#!/bin/sh\n[ "$1 $2" = "-m venv" ] && touch "{begun}" && sleep 60\nexec "{quick_python}" "$@"\n')
    slow.chmod(0o755)
    variables = [f"{name}={value}" for name, value in fresh_environ(PYTHON=str(slow), TERM="xterm").items()]
    with Terminal(["env", "-i", *variables, str(course.root / "environment-check.sh"), "lab"]) as terminal:
        terminal.wait_for("[1/4] Making the environment: ", 3)  # a busy machine leaves a second out
        lines = [line.rpartition("\r")[2] for line in terminal.text.split("\n")]
        assert len(lines) == 2 and lines[0].startswith("Setting up the course") and begun.exists()
        terminal.press(CTRL_C)
        assert terminal.end() != 0
        wait_until(lambda: not running(course.root / "environment-check.sh"), "the end of all that it has started")


def running(script: Path) -> list[int]:
    """The processes whose command names a script."""
    return [one.pid for one in psutil.process_iter(["cmdline"]) if str(script) in (one.info["cmdline"] or [])]


def give_uv(course: CourseCopy) -> None:
    """As after an earlier set-up: the installer has been fetched."""
    version = course.root / "build/uv-0.13.8/bin"
    version.mkdir(parents=True)
    (version / "uv").symlink_to(str(UV))


def failed(result: CompletedProcess[str]) -> dict[str, str]:
    """The parts of the explanation, which is all that a failed set-up says after it has begun."""
    assert result.returncode == 1, result.stderr
    begun, *lines = result.stderr.splitlines()
    assert begun.startswith("Setting up the course")
    steps = [line for line in lines if line.startswith("[")]
    assert [line.partition("]")[0] for line in steps] == [f"[{step}/4" for step in range(1, len(steps) + 1)]
    lines = lines[len(steps) :]
    assert len(lines) <= 5, result.stderr
    assert lines[0].startswith("environment-check: ")
    parts = dict(line.split(": ", 1) for line in lines)
    assert parts["log"].strip() == "build/set-up.log"
    return {name: text.strip() for name, text in parts.items()}


# ---- the network


class Index(BaseHTTPRequestHandler):
    """A package index, or a proxy to one."""

    protocol_version = "HTTP/1.1"

    def do_GET(self) -> None:
        self.server.asked.append(self.path)  # type: ignore[attr-defined]
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.send_header("Content-Length", "100000")
        self.end_headers()
        self.wfile.write(b"<html><body>\n")  # and then the line is cut
        self.close_connection = True

    def do_CONNECT(self) -> None:
        self.send_error(403)
        self.close_connection = True

    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def server() -> Iterator[ThreadingHTTPServer]:
    with serving(Index) as server:
        yield server


@pytest.fixture
def nobody() -> Iterator[int]:
    """A port at which nobody listens."""
    with socket.socket() as bound:
        bound.bind(("127.0.0.1", 0))
        yield bound.getsockname()[1]


@needs_root
def test_without_network_the_fetch_of_the_installer_fails_and_an_old_uv_is_left_alone(lab, tmp_path):
    old = tmp_path / "commands/uv"
    old.parent.mkdir()
    old.write_text(f"#!/bin/sh\necho \"$@\" >> '{tmp_path}/asked'\necho uv 0.4.30\n")
    old.chmod(0o755)
    said = failed(lab(view="mount --bind /dev/null /etc/resolv.conf"))  # nobody to ask for an address
    assert said["environment-check"] == "The installer uv could not be fetched."
    assert said["why"].startswith("There is no network")
    assert said["cure"].endswith("then: ./environment-check.sh lab")
    assert set((tmp_path / "asked").read_text().split()) == {"--version"}


@needs_uv
def test_a_network_that_is_lost_half_way(course, lab, server):
    give_uv(course)
    said = failed(lab(PIP_INDEX_URL=f"http://127.0.0.1:{server.server_port}/simple"))
    assert said["environment-check"] == "The packages could not be installed."
    assert said["why"].startswith("The network was lost")


def test_a_proxy_that_does_not_answer_is_named_without_its_password(lab, nobody):
    proxy = f"http://student:secret@127.0.0.1:{nobody}"
    said = failed(lab(HTTPS_PROXY=proxy))
    assert f"The proxy that is set here, http://127.0.0.1:{nobody}, refuses" in said["why"]
    assert "unset HTTPS_PROXY" in said["cure"]


@needs_uv
def test_a_proxy_that_refuses(course, lab, server):
    give_uv(course)
    said = failed(lab(HTTPS_PROXY=f"http://127.0.0.1:{server.server_port}"))
    assert "refuses or does not answer" in said["why"]


@pytest.fixture
def authority(tmp_path) -> Path:
    """The certificate of an authority that nobody knows; beside it those of a server on localhost that it signed."""
    if not shutil.which("openssl"):
        pytest.skip("needs openssl, to make a certificate")
    own, key, server, server_key = (str(tmp_path / name) for name in ("own.crt", "own.key", "server.crt", "server.key"))
    new = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2"]
    of_server = ["-addext", "subjectAltName=DNS:localhost", "-addext", "basicConstraints=critical,CA:FALSE"]
    for command in (
        [*new, "-subj", "/CN=An authority", "-keyout", key, "-out", own],
        [*new, "-subj", "/CN=localhost", *of_server, "-CA", own, "-CAkey", key, "-keyout", server_key, "-out", server],
    ):
        subprocess.run(command, check=True, capture_output=True, timeout=30)
    return Path(own)


@pytest.fixture
def secure(server, authority) -> str:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(authority.with_name("server.crt"), authority.with_name("server.key"))
    server.socket = context.wrap_socket(server.socket, server_side=True)
    return f"https://localhost:{server.server_port}/simple"


@needs_uv
def test_an_unknown_certificate_authority(course, lab, secure):
    give_uv(course)
    said = failed(lab(PIP_INDEX_URL=secure))
    assert "certificate" in said["why"]
    assert "SSL_CERT_FILE=" in said["cure"]


@needs_uv
@needs_root
@pytest.mark.parametrize("tool", ["pip", "uv"])
def test_an_authority_that_the_system_knows_is_trusted(course, lab, server, secure, authority, tool):
    if not Path(STORE).exists():
        pytest.skip(f"there is no {STORE}")
    if tool == "uv":
        give_uv(course)
    # Known to the machine: its store has it too, in a view of the files that only this command has.
    both = authority.with_name("both.crt")
    both.write_text(Path(STORE).read_text() + authority.read_text())
    result = lab(view=f"mount --bind {both} {STORE}", PIP_INDEX_URL=secure)
    assert "certificate" not in (course.root / "build/set-up.log").read_text()
    assert server.asked
    assert result.returncode == 1


# ---- the disk


@needs_root
def test_a_full_disk(course, lab, tmp_path):
    (small := tmp_path / "small").mkdir()
    layers = f"lowerdir={course.root},upperdir={small}/new,workdir={small}/work"
    view = f"mount -t tmpfs -o size=8m tmpfs {small} && mkdir {small}/new {small}/work"
    overlay = f"mount -t overlay -o '{layers}' overlay '{course.root}'"
    said = failed(lab(view=f"{view} && {overlay}"))
    assert said["why"].startswith("The disk is full: ")
    assert f"MB are free in {course.root}" in said["why"]


@needs_root
def test_a_folder_that_cannot_be_written_is_to_be_copied(course, lab):
    here = f"'{course.root}'"
    view = f"mount --bind {here} {here} && mount -o remount,ro,bind {here}"
    result = lab(view=view)
    assert result.returncode == 1
    assert len(result.stderr.splitlines()) == 1
    assert "cannot be written" in result.stderr
    assert f"cp -r '{course.root}' ~/course" in result.stderr


# ---- what other tools say


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("c++: fatal error: Killed signal terminated program cc1plus", "The machine has too little memory"),
        ("ERROR: THESE PACKAGES DO NOT MATCH THE HASHES FROM THE REQUIREMENTS FILE.", "What was downloaded is not"),
        ("error: failed to open `/home/me/.cache/uv/x`: Permission denied (os error 13)", "It may not write there."),
        ("ERROR: 403 Client Error: Forbidden for url: http://index/simple/uv/", "The package index asks"),
        ("something that nobody has foreseen", "It is none of the usual causes."),
    ],
)
def test_the_cause_is_read_from_the_last_step_in_the_log(tmp_path, line, why):
    log = tmp_path / "set-up.log"
    log.write_text(f"\n$ pip install uv\nNo space left on device\n\n$ uv pip install\nfirst\n{line}\n")
    assert f"said: {line}\nwhy:  {why}" in failure.explain("It failed.", log, "./environment-check.sh lab", os.environ)
