"""ROS domains for test processes: each gets one that no other test process of this machine uses."""

from __future__ import annotations

import itertools
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from tests.locks import lock

OF_TESTS = range(2, 102)  # without port clashes
OF_NO_TEST = 1

_locks: dict[int, socket.socket] = {}  # of the domains that this process has
_numbers = itertools.count(os.getpid())  # so that what was given back is taken last


def take(domain: int) -> bool:
    """Take a domain until it is given back, or this process ends, unless another test process has it."""
    if held := lock(f"course-kit-test-domain-{domain}"):
        _locks[domain] = held
    return held is not None


def reserve_domain() -> int:
    """A domain of one's own. RuntimeError when all are taken."""
    start = next(_numbers) % len(OF_TESTS)
    for domain in (*OF_TESTS[start:], *OF_TESTS[:start]):
        if take(domain):
            return domain
    raise RuntimeError(f"{len(OF_TESTS)} test processes run already: no ROS domain is left")


@contextmanager
def reserved_domain() -> Iterator[int]:
    """A domain of one's own, in which nothing is left at the end of the block: then it is given back."""
    domain = reserve_domain()
    yield domain
    _locks.pop(domain).close()  # not after an error: something may be left in it


@contextmanager
def own_domain() -> Iterator[int]:
    """A ROS domain without the nodes that other tests of this process have left: this process and its children use it.

    Nothing is left in it at the end of the block.
    """
    with reserved_domain() as domain, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        yield domain


def use_own_domain() -> int:
    """Put this process and its children into a domain of their own, on this machine only; return the domain."""
    domain = reserve_domain()
    os.environ["ROS_DOMAIN_ID"] = str(domain)
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ.pop("ROS_LOCALHOST_ONLY", None)
    return domain
