"""The picture of what a build has installed: each file, what it came from, and who looks for it."""

from __future__ import annotations

import pytest

from course_kit import Workspace
from course_kit.setup.colcon.install_plots import Installed, installed, plot_install
from tests import packages


@pytest.fixture
def workspace(tmp_path) -> Workspace:
    """demo_py as colcon installs it."""
    workspace = Workspace(tmp_path / "ros2_ws")
    packages.add_python_package(workspace.src)
    source = workspace.src / "demo_py"
    modules = "lib/python3.11/site-packages/demo_py"
    packages.write(
        workspace.install / "demo_py",
        {
            "lib/demo_py/talker": "#!/usr/bin/python3",
            f"{modules}/__init__.py": "",
            f"{modules}/talker.py": (source / "demo_py/talker.py").read_text(),
            f"{modules}/__pycache__/talker.cpython-311.pyc": "compiled",
            f"{modules}-0.0.0-py3.11.egg-info/PKG-INFO": "Name: demo_py",
            "share/ament_index/resource_index/packages/demo_py": "",
            "share/colcon-core/packages/demo_py": "rclpy",
            "share/demo_py/hook/pythonpath.sh": "",
            "share/demo_py/launch/demo.launch.py": (source / "launch/demo.launch.py").read_text(),
            "share/demo_py/package.sh": "",
            "share/demo_py/package.xml": (source / "package.xml").read_text(),
        },
    )
    return workspace


def test_each_file_is_told_with_its_origin_and_who_looks_for_it(workspace):
    assert installed(workspace, "demo_py") == [
        Installed("setup.py: entry_points", "lib/demo_py/talker", "ros2 run"),
        Installed("demo_py/__init__.py", "lib/python3.11/site-packages/demo_py/__init__.py", "import"),
        Installed("demo_py/talker.py", "lib/python3.11/site-packages/demo_py/talker.py", "import"),
        Installed("launch/demo.launch.py", "share/demo_py/launch/demo.launch.py", "ros2 launch"),
        Installed("package.xml", "share/demo_py/package.xml", "ros2 pkg xml"),
        Installed("resource/demo_py", "share/ament_index/resource_index/packages/demo_py", "ros2, nodes: to find it"),
    ]


def test_the_picture_names_every_file_once(workspace):
    plot = plot_install(workspace, "demo_py")
    assert "; share/demo_py/package.xml from package.xml, found by ros2 pkg xml; " in repr(plot)
    texts = [text.get_text() for text in plot.axes[0].texts]
    for row in installed(workspace, "demo_py"):
        assert texts.count(row.source) == texts.count(row.target) == texts.count(row.reader) == 1, row


def test_what_was_not_built_cannot_be_drawn(workspace):
    with pytest.raises(ValueError, match=r"there is no demo_cpp in .*: was it built\?"):
        plot_install(workspace, "demo_cpp")
