"""Why a step of set-up failed, told in five lines from what the tools wrote into the log.

python -m course_kit.setup.environment.failure "The packages could not be installed." build/set-up.log AGAIN
python -m course_kit.setup.environment.failure --of-the-network build/set-up.log    exit status 0: that is the cause

AGAIN is the command to repeat when the cause is removed. If it is `course grade`, all is told in one line.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

from course_kit.setup.environment.checks.machine import NEEDED_DISK

OF_SET_UP = "./environment-check.sh"  # what such a command begins with
FULL = 20  # MB: less than that and a disk counts as full, whatever the log says
LINE = 150  # characters of the log's line that are shown
PROXIES = ("HTTPS_PROXY", "https_proxy", "ALL_PROXY", "all_proxy", "HTTP_PROXY", "http_proxy")


@dataclass(frozen=True)
class Cause:
    """The likeliest cause of what a log says: words that give it away, an explanation, a cure."""

    sign: str  # a regular expression
    why: str
    cure: str
    network: bool = False


CAUSES = (
    Cause(
        r"No space left on device|Disk quota exceeded",
        f"The disk is full: {{space}}. Set-up needs {NEEDED_DISK} MB.",
        "free some space (this shows where it went: du -xh ~ | sort -h | tail), then: {again}",
    ),
    Cause(
        r"Read-only file system|Permission denied",
        "It may not write there.",
        "make that folder yours, or put the installer's cache elsewhere: UV_CACHE_DIR=/tmp/uv-cache {again}",
    ),
    Cause(
        r"UnknownIssuer|CERTIFICATE_VERIFY_FAILED|invalid peer certificate|certificate verify failed",
        "A proxy or virus scanner on the way signs with a certificate that this machine does not know.",
        "ask its administrator for the certificate as a .crt file, then: SSL_CERT_FILE=/path/to/it.crt {again}",
        network=True,
    ),
    Cause(
        r"tunnel error|ProxyError|Cannot connect to proxy|407 Proxy|Tunnel connection failed",
        "The proxy that is set here, {proxy}, refuses or does not answer.",
        "correct it: export HTTPS_PROXY=http://HOST:PORT, or try without: unset {proxies}",
        network=True,
    ),
    Cause(
        r"\b40[13] (Unauthorized|Forbidden)|\b40[13] (Client )?Error",
        "The package index asks for a login or refuses.",
        "look at UV_DEFAULT_INDEX, PIP_INDEX_URL and `pip config list`, then: {again}",
        network=True,
    ),
    Cause(
        r"THESE PACKAGES DO NOT MATCH THE HASHES|[Hh]ash mismatch",
        "What was downloaded is not the package that the course is tested with: damaged, or changed by a mirror.",
        "clear the caches (rm -rf ~/.cache/uv ~/.cache/pip) and do without the mirror, then: {again}",
    ),
    Cause(
        r"dns error|name resolution|getaddrinfo|NameResolutionError|Name or service not known",
        "There is no network: the address of the package index cannot be looked up.",
        "connect to the network (set-up needs it once), then: {again}",
        network=True,
    ),
    Cause(
        r"error sending request|[Cc]onnection (refused|reset|closed|aborted|broken)|timed out|unreachable|"
        r"Failed to (fetch|download)|decoding response body|IncompleteRead|Retrying \(|Request failed after",
        "The network was lost, or the package index does not answer.",
        "look whether the network is back, then: {again}. What was downloaded is kept",
        network=True,
    ),
    Cause(
        r"No matching distribution|No solution found|not found in the (package registry|cache)",
        "The package index in use does not have all packages.",
        "do without the mirror: env -u UV_DEFAULT_INDEX -u UV_INDEX_URL -u PIP_INDEX_URL {again}",
    ),
    Cause(
        r"Killed signal|terminated with signal|signal: 9|Cannot allocate memory|MemoryError|died with .*SIGKILL",
        "The machine has too little memory for the compiler.",
        "close other programs, or give the machine 2 GB, then: {again}",
    ),
    Cause(
        r"No C\+\+ compiler|Python\.h of|fatal error:",
        "The compiler or Python's headers are not whole.",
        "sudo apt-get install -y g++ python3-dev, then: {again}",
    ),
)
OTHER = Cause("", "It is none of the usual causes.", "try once more: {again}; if that does not help, report the log")


def last_step(log: Path) -> str:
    """What the step that failed has written: each begins with its command."""
    text = log.read_text(errors="replace") if log.exists() else ""
    return text.rpartition("\n$ ")[2].partition("\n")[2]


def cause(log: str) -> tuple[Cause, str]:
    """The likeliest cause and the line of the log that gives it away: the first that is found, so the order counts."""
    lines = [line.strip() for line in log.splitlines() if line.strip()]
    for known in CAUSES:
        line = next((line for line in reversed(lines) if re.search(known.sign, line)), None)
        if line is not None:
            return known, line
    return OTHER, lines[-1] if lines else ""


def fullest(folders: list[Path]) -> tuple[int, Path]:
    """Free space in MB of the folder that has least; of those that are not there yet, of their parents."""
    there = [next(p for p in (folder, *folder.parents) if p.exists()) for folder in folders]
    return min((shutil.disk_usage(folder).free // 1_000_000, folder) for folder in there)


def explain(what: str, log: Path, again: str, environ: Mapping[str, str]) -> str:
    """Five lines at most: what failed, in the tool's words too; the likeliest cause; the cure; where all of it is.

    The failure of another command than set-up is told in one line, without the tool's words.
    """
    cache = environ.get("UV_CACHE_DIR") or os.path.join(environ.get("HOME", "/"), ".cache")
    free, folder = fullest([log.parent.absolute(), Path(cache), Path(tempfile.gettempdir())])
    found, line = cause(last_step(log)) if free >= FULL else (CAUSES[0], "")
    proxy = next((environ[name] for name in PROXIES if environ.get(name)), "")
    shown = urlsplit(proxy)._replace(netloc=urlsplit(proxy).netloc.rpartition("@")[2]).geturl()  # without a password
    why = found.why.format(space=f"{free} MB are free in {folder}", proxy=shown)
    cure = found.cure.format(again=again, proxies=" ".join(PROXIES))
    if not again.startswith(OF_SET_UP):
        return f"environment-check: {what} {why} Cure: {cure}. Log: {log.absolute()}"
    said = [f"said: {line[:LINE]}"] if line else []
    return "\n".join([f"environment-check: {what}", *said, f"why:  {why}", f"cure: {cure}", f"log:  {log}"])


def main(what: str, log: str, again: str = OF_SET_UP) -> int:
    """What the script calls when a step of set-up has failed."""
    if what == "--of-the-network":
        return 0 if cause(last_step(Path(log)))[0].network else 1
    print(explain(what, Path(log), again, os.environ))
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
