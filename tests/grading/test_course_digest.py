"""The digest under which results of grading are kept: everything that a verdict depends on changes it."""

from __future__ import annotations

import importlib.metadata
import shutil
from pathlib import Path

import pytest

from course_kit.classroom.run import course_digest

FILES = (
    "exercises/topics/topics_1_countdown.py",
    "exercises/checker/robot_interfaces/msg/Battery.msg",
    "robots/robot/worlds/office.yaml",
    "setup/environment/fastdds_profile.xml",
    "setup/environment/requirements.lock",
    "setup/interfaces/turtlesim/msg/Pose.msg",
)


@pytest.fixture(scope="module")
def kit(tmp_path_factory: pytest.TempPathFactory) -> Path:
    copy = tmp_path_factory.mktemp("course") / "course_kit"
    return Path(shutil.copytree(course_digest.KIT, copy, ignore=shutil.ignore_patterns("__pycache__")))


@pytest.mark.parametrize("name", FILES)
def test_a_changed_file_changes_it(kit: Path, name: str):
    file, before = kit / name, course_digest.digest(kit, {})
    content = file.read_bytes()
    file.write_bytes(content + b"\n")
    changed = course_digest.digest(kit, {})
    file.write_bytes(content)
    assert changed != before == course_digest.digest(kit, {})


def test_a_renamed_file_changes_it(kit: Path):
    before = course_digest.digest(kit, {})
    (kit / "robots/robot/worlds/office.yaml").rename(kit / "robots/robot/worlds/hall.yaml")
    assert course_digest.digest(kit, {}) != before
    (kit / "robots/robot/worlds/hall.yaml").rename(kit / "robots/robot/worlds/office.yaml")


def test_an_edition_without_solutions_grades_alike(kit: Path):
    before = course_digest.digest(kit, {})
    shutil.rmtree(kit / "exercises/topics/solutions")
    (kit / "exercises/__pycache__").mkdir()
    (kit / "exercises/__pycache__/catalogue.pyc").touch()
    assert course_digest.digest(kit, {}) == before


def test_an_upgraded_package_changes_it(kit: Path, monkeypatch: pytest.MonkeyPatch):
    before, version = course_digest.digest(kit, {}), importlib.metadata.version
    monkeypatch.setattr(importlib.metadata, "version", lambda name: "9.9.9" if name == "mujoco" else version(name))
    assert course_digest.digest(kit, {}) != before


def test_an_upgraded_ros_changes_it(kit: Path, tmp_path: Path):
    (tmp_path / "share/ament_index/resource_index/packages").mkdir(parents=True)
    (tmp_path / "share/ament_index/resource_index/packages/rclpy").touch()
    manifest = tmp_path / "share/rclpy/package.xml"
    manifest.parent.mkdir()
    sourced, found = {"AMENT_PREFIX_PATH": str(tmp_path), "ROS_DISTRO": "jazzy"}, {course_digest.digest(kit, {})}
    for version in ("7.1.6", "7.1.7"):
        manifest.write_text(f"<package><name>rclpy</name><version>{version}</version></package>")
        found.add(course_digest.digest(kit, sourced))
    assert len(found) == 3
