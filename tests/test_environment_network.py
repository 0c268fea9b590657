"""Checks of loopback, shared memory and ports."""

from __future__ import annotations

import socket

import pytest

from course_kit.setup.environment.checks import network


def test_a_packet_gets_through_the_loopback_interface():
    assert network.loopback().status == "PASS"


def test_an_address_that_no_interface_of_this_machine_has_fails():
    check = network.loopback("192.0.2.1")  # reserved for documentation
    assert check.status == "FAIL"
    assert "ip link set lo up" in check.cure


def test_shared_memory_of_this_machine_is_measured():
    check = network.shared_memory()
    assert check.status in ("PASS", "WARN")
    assert "/dev/shm" in check.detail


def test_missing_shared_memory_warns(tmp_path):
    check = network.shared_memory(tmp_path / "shm")
    assert (check.status, check.detail) == ("WARN", f"{tmp_path / 'shm'} is not there")


@pytest.mark.parametrize(("free", "status"), [(64, "PASS"), (32, "PASS"), (31, "WARN"), (0, "WARN")])
def test_little_shared_memory_warns(tmp_path, free, status):
    assert network.shared_memory_space(tmp_path, free, 500).status == status


def test_the_64_mib_of_a_container_are_enough_until_they_are_used_up(tmp_path):
    check = network.shared_memory_space(tmp_path, 60, 67)
    assert (check.status, "container" in check.detail) == ("PASS", True)
    check = network.shared_memory_space(tmp_path, 20, 67)
    assert (check.status, "--shm-size=512m" in check.cure) == ("WARN", True)


@pytest.fixture
def listening():
    """A server on a port of its own."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as server:
        server.bind((network.LOOPBACK, 0))
        server.listen()
        yield server.getsockname()[1]


def test_a_free_port_passes_and_a_taken_one_moves_on(listening):
    assert not network.is_free(listening)
    check = network.ports(range(listening, listening + 51))
    assert check.status == "PASS"
    assert check.detail.startswith(f"{listening} is taken, JupyterLab will use ")


def test_no_free_port_at_all_fails(listening):
    assert network.ports(range(listening, listening + 1)).status == "FAIL"
