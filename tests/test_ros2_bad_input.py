"""`ros2` and what makes no sense: a line that says what is wrong, at once, whatever verb it is given to."""

from __future__ import annotations

import contextlib
import io
import re
import signal
import subprocess
import threading
import time
from argparse import Action, ArgumentTypeError
from collections.abc import Iterator
from typing import Any

import pytest

from course_kit.cli.ros2 import command
from course_kit.cli.ros2.command import COMMANDS
from course_kit.lab.background.running import run as start
from course_kit.lab.background.running import stop
from course_kit.robots.turtlesim.node import TurtleSim
from tests.domains import own_domain
from tests.kernel import Kernel
from tests.ros2_bad_calls import CALLS
from tests.ros2_bad_calls.call import FILES, FOLDERS, NO_TEXT, Bad
from tests.ros2_command import COMMAND
from tests.test_ros2_help import parser_of, parsers_below

pytestmark = pytest.mark.by_turns("a program or a cell for each", of="cases")

TIMEOUT = 10.0  # seconds for a call; most need a tenth
MOST = 4000  # characters of output
INNER = re.compile(r"Traceback|\b\w+(Error|Exception)\b(?!s)|<class |NoneType|not supported between")
# The real command's own words, which scripts may read, name Python's errors and types.
REAL = re.compile(
    r"Failed to populate message fields: \w+|expected to be a dictionary but is a \w+"
    r"|\(see debug for traceback\)|^ - \w+:",
    re.MULTILINE,
)


@pytest.fixture(scope="module", autouse=True)
def turtlesim(fresh_domain: None) -> Iterator[None]:
    node = start(TurtleSim)
    yield
    stop(node)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    """What stands for the files of the table. Launches log beside them, and what is made here is made there."""
    folder = tmp_path_factory.mktemp("bad")
    for name, text in FILES.values():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8", errors="surrogateescape")
    (folder / "empty").mkdir()
    names = {sign: name for sign, (name, _) in FILES.items()} | FOLDERS
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_LOG_DIR", str(folder / "log"))
        patch.chdir(folder)
        yield {sign: str(folder / name) for sign, name in names.items()}


def run(words: list[str]) -> tuple[int, float]:
    """Run a command line in this process, as `%ros2` does: its exit status, and how many seconds it took.

    One that takes too long is interrupted.
    """
    main = threading.main_thread().ident
    assert main is not None
    late = threading.Timer(TIMEOUT, signal.pthread_kill, (main, signal.SIGINT))
    late.start()
    began = time.monotonic()
    try:
        return command.run(words), time.monotonic() - began
    except SystemExit as usage:
        return int(usage.code or 0), time.monotonic() - began
    finally:
        late.cancel()


IN_A_NOTEBOOK = """
import contextlib, io, shlex
from course_kit import run
from course_kit import TurtleSim
from tests.ros2_bad_calls import CALLS

turtle, said, magic = run(TurtleSim), [], get_ipython().run_line_magic
for bad in CALLS[::STEP]:
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(out):
        magic("ros2", shlex.join(bad.words(FILES)))
    said.append((bad, out.getvalue()))
"""
STEP = 6  # every 6th case of the table also in a notebook
JUDGED = "print([(bad, text[:500]) for bad, text in said if len(text) > MOST or not re.search(bad.says, text, re.S)])"


NUMBERS = ("", "nan", "inf", "-inf", "1e400", "-1", "five", "½", "x" * 100_000)
# Where -1 has a meaning, or is refused in other words.
HAS_NEGATIVE = {"--qos-depth", "--qos-liveliness-lease-duration-seconds"}
HAS_NEGATIVE |= {"--playback-duration", "--playback-until-sec", "--playback-until-nsec"}


def options() -> Iterator[tuple[str, Action]]:
    """Every option of every verb, with the words before it."""
    for name in COMMANDS:
        for verb in ((), *((one,) for one in parsers_below(parser_of(name)))):
            for action in parser_of(name, *verb)._actions:
                yield f"{' '.join((name, *verb))} {max(action.option_strings, key=len, default=action.dest)}", action


def test_each_option_that_has_a_number_takes_nothing_else() -> None:
    """One kind of converter reads them all, so each verb refuses the same in the same words."""
    found = dict(options())
    numeric = {name: action.type for name, action in found.items() if is_number(action)}
    assert len(numeric) > 80
    assert [name for name, one in found.items() if isinstance(one.default, float | int) and not takes_text(one)] == []
    taken = {(name, text) for name, convert in numeric.items() for text in NUMBERS if takes(convert, text)}
    assert taken == {
        (name, "-1") for name in numeric if name.split()[-1] in HAS_NEGATIVE or name == "service call --rate"
    }


def takes(convert: Any, text: str) -> bool:
    with contextlib.suppress(ArgumentTypeError):
        convert(text)
        return True
    return False


def is_number(action: Action) -> bool:
    return getattr(action.type, "__qualname__", "").startswith("number.")


def takes_text(action: Action) -> bool:
    """Return True for a flag, a choice, and an option with a converter of numbers."""
    return is_number(action) or action.nargs == 0 or bool(action.choices)


def shown(bad: Bad) -> str:
    return bad.line[:80]


@pytest.mark.parametrize("bad", CALLS, ids=shown)
def test_what_makes_no_sense_is_refused_in_a_line(
    bad: Bad, files: dict[str, str], capsys: pytest.CaptureFixture[str], recwarn: pytest.WarningsRecorder
) -> None:
    status, seconds = run(bad.words(files))
    printed = "".join(capsys.readouterr())
    assert seconds < TIMEOUT, printed[:MOST]
    assert (status, bool(re.search(bad.says, printed, re.DOTALL))) == (bad.status, True), printed[:MOST]
    assert len(printed) < MOST
    assert not INNER.search(REAL.sub("", printed)), printed
    # A terminal would show them; those of libraries about themselves it does not.
    assert not [warning for warning in recwarn if not issubclass(warning.category, DeprecationWarning)]


@pytest.mark.parametrize("text", [b"\xff\xfe\xfd", b"{", b"\0", b"[" * 1000, b"!!int x", b"{data: *a}"], ids=repr)
@pytest.mark.parametrize(
    "line",
    [
        "topic pub /talk std_msgs/msg/String --stdin",
        "service call /spawn turtlesim/srv/Spawn --stdin",
        "action send_goal /turtle1/rotate_absolute turtlesim/action/RotateAbsolute --stdin",
    ],
)
def test_what_is_no_yaml_is_refused_from_the_standard_input_too(
    line: str, text: bytes, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(text)))
    status, _ = run(line.split())
    printed = "".join(capsys.readouterr())
    assert (status, printed.count("\n")) == (1, 1)
    assert "YAML" in printed


def test_what_makes_no_sense_is_refused_in_a_notebook_as_in_a_terminal(files: dict[str, str]) -> None:
    with own_domain():
        kernel = Kernel()
        try:
            kernel.run(f"FILES, STEP, MOST = {files!r}, {STEP}, {MOST}")
            kernel.run(IN_A_NOTEBOOK, timeout=100)
            assert kernel.text(kernel.run(f"import re; print(len(said)); {JUDGED}")) == f"{len(CALLS[::STEP])}\n[]\n"
        finally:
            kernel.close()


def test_progress_takes_no_argument() -> None:
    kernel = Kernel()
    try:
        for argument in ("'topics-1'", "'nan'", "'x' * 100_000", '"\'"', "'ünï'"):
            said = kernel.text(kernel.run(f"get_ipython().run_line_magic('progress', {argument})"))
            assert said.startswith("%progress takes no argument: it shows all chapters.")
            assert said.count("\n") == 1
    finally:
        kernel.close()


def test_a_word_that_is_no_utf_8_is_refused_in_a_terminal() -> None:
    words = [*COMMAND, "node", "info", "caf\udce9"]  # one byte, as in Latin-1
    refused = subprocess.run(words, capture_output=True, text=True, timeout=60)
    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr.splitlines()[-1] == f"ros2: error: 'caf\\udce9' {NO_TEXT}"
