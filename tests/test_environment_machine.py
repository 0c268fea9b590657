"""Checks of the machine: operating system, C library, processor, memory, disk."""

from __future__ import annotations

from pathlib import Path

import pytest

from course_kit.setup.environment.checks import machine


def test_linux_passes_with_the_name_of_the_distribution():
    check = machine.operating_system("Linux", {"PRETTY_NAME": "Ubuntu 24.04.2 LTS"})
    assert (check.status, check.detail) == ("PASS", "Ubuntu 24.04.2 LTS")


@pytest.mark.parametrize("system", ["Darwin", "Windows"])
def test_other_systems_fail(system):
    check = machine.operating_system(system, {})
    assert check.status == "FAIL"
    assert "wsl --install" in check.cure


UBUNTU = {"PRETTY_NAME": "Ubuntu 24.04.2 LTS", "NAME": "Ubuntu"}


def test_wsl_2_passes_and_wsl_1_has_to_be_converted():
    check = machine.operating_system("Linux", UBUNTU, "5.15.167.4-microsoft-standard-WSL2")
    assert (check.status, check.detail) == ("PASS", "Ubuntu 24.04.2 LTS in WSL 2")
    check = machine.operating_system("Linux", UBUNTU, "4.4.0-19041-Microsoft")
    assert (check.status, check.cure.rpartition(": ")[2]) == ("FAIL", "wsl --set-version Ubuntu 2")


def test_a_folder_of_windows_is_a_slow_place_for_the_course(monkeypatch):
    monkeypatch.setattr("platform.release", lambda: "5.15.167.4-microsoft-standard-WSL2")
    assert machine.disk(Path("/mnt/c/Users/me/course"), ready=True).status == "WARN"
    assert not machine.is_of_windows(Path("/home/me/course"))
    assert not machine.is_of_windows(Path("/mnt/data/course"))


@pytest.mark.parametrize("version", ["glibc 2.28", "glibc 2.36", "glibc 2.100", "glibc 3.0"])
def test_a_c_library_that_the_wheels_run_on_passes(version):
    assert machine.c_library(version).status == "PASS"


@pytest.mark.parametrize("version", ["glibc 2.27", "glibc 2.9", "musl 1.2.5", "glibc new", ""])
def test_an_older_or_another_c_library_fails(version):
    check = machine.c_library(version)
    assert check.status == "FAIL"
    assert "2.28" in check.reason


def test_this_machine_has_a_c_library_that_the_check_can_read():
    assert machine.c_library(machine.c_library_version()).status == "PASS"


def test_only_x86_64_runs_the_wheels():
    assert machine.architecture("x86_64", sourced=False).status == "PASS"
    check = machine.architecture("aarch64", sourced=False)
    assert check.status == "FAIL"
    assert "ros-jazzy-ros-base" in check.cure
    assert check.cure.endswith("source /opt/ros/jazzy/setup.bash")


def test_any_architecture_will_do_beside_a_sourced_ros():
    assert machine.architecture("aarch64", sourced=True).status == "PASS"


@pytest.fixture
def meminfo(tmp_path):
    path = tmp_path / "meminfo"
    path.write_text("MemTotal:       16000000 kB\nMemFree:  100 kB\nMemAvailable:    8000000 kB\nHugePages:  0\n")
    return path


def test_memory_is_read_in_megabytes(meminfo, tmp_path):
    assert machine.available_memory(meminfo, tmp_path / "no cgroup") == (8000, 16000)


def test_the_memory_limit_of_a_container_counts_without_what_it_can_give_back(meminfo, tmp_path):
    (tmp_path / "memory.max").write_text("2000000000\n")
    (tmp_path / "memory.current").write_text("1500000000\n")
    (tmp_path / "memory.stat").write_text("anon 900000000\ninactive_file 600000000\n")
    assert machine.available_memory(meminfo, tmp_path) == (1100, 2000)


def test_a_container_without_a_limit_has_the_memory_of_the_machine(meminfo, tmp_path):
    (tmp_path / "memory.max").write_text("max\n")
    (tmp_path / "memory.current").write_text("1500000000\n")
    assert machine.available_memory(meminfo, tmp_path) == (8000, 16000)


@pytest.mark.parametrize(
    ("available", "total", "status"),
    [(8000, 16000, "PASS"), (1000, 1000, "PASS"), (999, 16000, "WARN"), (100, 2000, "WARN"), (300, 499, "FAIL")],
)
def test_too_little_memory_warns_and_far_too_little_fails(available, total, status):
    assert machine.memory(available, total).status == status


@pytest.mark.parametrize(
    ("free", "writable", "ready", "status"),
    [
        (5000, True, False, "PASS"),
        (1199, True, False, "FAIL"),
        (1199, True, True, "PASS"),
        (199, True, True, "WARN"),
        (5000, False, False, "FAIL"),
        (5000, False, True, "PASS"),
    ],
)
def test_disk_needs_room_for_the_set_up_once_and_for_recordings_always(tmp_path, free, writable, ready, status):
    assert machine.disk_space(tmp_path, free, writable, ready).status == status


def test_the_disk_of_this_folder_can_be_read(tmp_path):
    assert machine.disk(tmp_path, ready=True).detail.endswith("MB free for the course")
