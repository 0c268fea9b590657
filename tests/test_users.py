"""Many users on one machine: no two of them have the same domain or test domain, and what has ended is free again."""

from __future__ import annotations

import contextlib
import itertools
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from course_kit.exercises import domains
from course_kit.setup.environment import user_domain

pytestmark = pytest.mark.skipif(os.getuid() != 0, reason="only root can be several users")

TAKE = "take(os.getuid(){})"
RESERVE = "reserve_domain()"
# Users of the course have another of the ports that DDS leaves free, also those beside this test.
PORT, OTHER_PORT = f"UNUSED = {user_domain.UNUSED}", f"UNUSED = {user_domain.UNUSED + 1}"
# Users who prefer the same domain, 43.
ANN, BOB, EVE = 3042, 3142, 3242


@contextlib.contextmanager
def process(uid: int, module: str, call: str) -> Iterator[subprocess.Popen[str]]:
    """A process of a user who need not be able to read the course; it prints what a call of a module gives.

    It does not look into shared memory, where other tests have ports.
    """
    text = Path(module).read_text().replace("from __future__ import annotations", "")
    text = text.replace(user_domain.SHARED_MEMORY, "/nowhere").replace(PORT, OTHER_PORT)
    before = f"import contextlib, os, socket, sys\nos.setgid({uid})\nos.setuid({uid})\n"
    after = f"\nprint({call}, flush=True)\nsys.stdin.read()"
    command = [sys.executable, "-ISc", before + text + after]
    running = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd="/")
    try:
        yield running
    finally:
        running.communicate(timeout=20)


def told(running: subprocess.Popen[str]) -> int:
    assert running.stdout is not None
    return int(running.stdout.readline())


@contextlib.contextmanager
def domain_of(uid: int, given: str = "") -> Iterator[int]:
    """The domain that a new process of a user takes, while it lives."""
    with process(uid, user_domain.__file__, TAKE.format(given and f", {given!r}")) as running:
        yield told(running)


def test_users_of_one_number_get_domains_of_their_own() -> None:
    with domain_of(ANN) as anns, domain_of(BOB) as bobs, domain_of(EVE) as eves:
        assert (anns, bobs, eves) == (43, 44, 45)


def test_a_users_processes_share_a_domain_until_the_last_one_ends() -> None:
    with contextlib.ExitStack() as anns:
        assert anns.enter_context(domain_of(ANN)) == 43
        with domain_of(BOB) as first:
            with domain_of(BOB) as second, domain_of(BOB, str(first)) as child:
                assert (first, second, child) == (44, 44, 44)
            anns.close()  # 43 is free, but Bob's other processes are in 44
            with domain_of(BOB) as third:
                assert third == 44
        with domain_of(BOB) as later:
            assert later == 43


def test_a_process_keeps_the_domain_of_a_parent_that_has_ended() -> None:
    with domain_of(BOB, "43"), domain_of(ANN) as anns:
        assert anns == 44


def test_killed_processes_hold_nothing() -> None:
    with process(BOB, user_domain.__file__, TAKE.format("")) as running:
        assert told(running) == 43
        running.kill()
        running.wait(10)
        with domain_of(ANN) as anns:
            assert anns == 43


def test_a_process_that_replaces_itself_as_those_with_wheels_do_holds_its_domain_on() -> None:
    following = ["sh", "-c", "echo 43; read end"]
    replace = f"[take(os.getuid()), hold_over_restart(), os.execv('/bin/sh', {following})]"
    with process(ANN, user_domain.__file__, replace) as running:
        assert told(running) == 43
        with domain_of(BOB) as bobs:
            assert bobs == 44


def test_programs_do_not_inherit_the_lock_of_a_process_with_wheels() -> None:
    code = """if True:
        import os
        print(os.environ.get("COURSE_KIT_LOCKS"), flush=True)
        os.execv("/bin/ls", ["ls", "-l", "/proc/self/fd"])
    """
    done = subprocess.run([sys.executable, "-c", code], env={}, capture_output=True, text=True, timeout=30)
    assert done.stdout.startswith("None\n"), done.stderr
    assert "socket" not in done.stdout


@pytest.mark.parametrize(
    ("module", "call"), [(user_domain, TAKE.format("")), (domains, RESERVE)], ids=["domain", "stage"]
)
def test_sixty_users_at_once_share_nothing(module, call) -> None:
    users = [4000 + 50 * number for number in range(60)]  # 30 prefer one domain, 30 another
    with contextlib.ExitStack() as all_of_them:
        running = [all_of_them.enter_context(process(uid, module.__file__, call)) for uid in users]
        given = [told(one) for one in running]
        assert len(set(given)) == len(users), given
        assert set(given) <= set(user_domain.DOMAINS if module is user_domain else domains.TEST_DOMAINS)
    with process(users[0], module.__file__, call) as after:
        assert told(after) in given


def test_unique_network_flows_of_no_two_users_meet_and_other_ports_are_those_of_rtps() -> None:
    flows = [first_flow(domain) for domain in (0, *user_domain.DOMAINS)]
    assert flows[0] == 7000  # as without a profile
    assert {before - after for before, after in itertools.pairwise(flows)} == {user_domain.FLOWS}
    assert min(flows) > 1023  # below, only root may use a port


def first_flow(domain: int) -> int:
    """The first port of the unique network flows of a domain's user, whose offsets make up for the lower base."""
    base, offset, following = map(int, user_domain.ports_of(str(domain)).values())
    offsets = [int(f"{offset}0"), int(f"{following}0"), int(f"{offset}1"), int(f"{following}1")]
    assert [base + each for each in offsets] == [7400, 7410, 7401, 7411]
    return base - 400


def test_a_domain_in_which_another_user_left_ports_is_taken_last(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(user_domain, "SHARED_MEMORY", str(tmp_path))
    monkeypatch.setattr(user_domain, "_held_by", lambda uid: [])
    monkeypatch.setattr(user_domain, "_hold", lambda domain: True)
    leave(tmp_path, BOB, "fastrtps_port18161", "fastrtps_port5241_el", "fastrtps_0123456789abcdef", "fastrtps_portal")
    assert user_domain.take(ANN) == "45"  # 43 by its own port, 44 by one of a unique network flow
    assert user_domain.take(BOB) == "43"
    leave(tmp_path, EVE, *(f"fastrtps_port{first_flow(domain)}" for domain in user_domain.DOMAINS))
    assert user_domain.take(ANN) == "43"


def leave(folder: Path, uid: int, *names: str) -> None:
    for name in names:
        Path(folder, name).touch()
        os.chown(Path(folder, name), uid, uid)
