"""Checks of JupyterLab, its kernel, its widgets and a browser."""

from __future__ import annotations

import pytest

from course_kit.setup.environment.checks import notebook
from course_kit.setup.environment.interpreter import Interpreter

VERSIONS = {"jupyterlab": "4.6.6", "ipykernel": "7.3.0", "ipywidgets": "8.1.9", "anywidget": "0.11.0"}
KERNEL = "share/jupyter/kernels/python3/kernel.json"
EXTENSIONS = [f"share/jupyter/labextensions/{folder}/package.json" for folder in notebook.WIDGETS.values()]


@pytest.fixture
def environment(tmp_path):
    """A function that makes an environment with these files and distributions."""

    def make(files=(KERNEL, *EXTENSIONS), distributions=VERSIONS) -> Interpreter:
        for file in files:
            (tmp_path / file).parent.mkdir(parents=True)
            (tmp_path / file).write_text("{}")
        return Interpreter("python", (3, 11, 7), str(tmp_path), True, True, distributions)

    return make


def test_jupyterlab_with_its_kernel_and_widgets_passes(environment):
    python = environment()
    assert notebook.jupyterlab(python).detail == "4.6.6, ipykernel 7.3.0"
    assert notebook.widgets(python).detail == "ipywidgets 8.1.9, anywidget 0.11.0"


def test_a_missing_kernel_fails(environment):
    check = notebook.jupyterlab(environment(files=[]))
    assert check.status == "FAIL"
    assert "kernel python3" in check.detail


def test_a_missing_package_fails(environment):
    python = environment(distributions={"ipykernel": "7.3.0", "ipywidgets": "8.1.9"})
    assert "jupyterlab missing" in notebook.jupyterlab(python).detail
    assert "anywidget missing" in notebook.widgets(python).detail


@pytest.mark.parametrize("present", EXTENSIONS)
def test_widgets_without_their_javascript_fail(environment, present):
    check = notebook.widgets(environment(files=[present]))
    assert check.status == "FAIL"


def test_a_browser_needs_a_screen_and_a_program(tmp_path):
    (tmp_path / "firefox").touch(mode=0o755)
    screen, program = {"DISPLAY": ":0"}, {"PATH": str(tmp_path)}
    assert notebook.has_browser(screen | program)
    assert notebook.has_browser({"WAYLAND_DISPLAY": "wayland-0"} | program)
    assert not notebook.has_browser(program)
    assert not notebook.has_browser(screen | {"PATH": "/nowhere"})
    assert notebook.has_browser({"BROWSER": "/usr/bin/wslview"})


def test_a_machine_without_a_browser_is_fine():
    check = notebook.browser({"PATH": "/nowhere"})
    assert (check.status, "prints the address" in check.detail) == ("PASS", True)


def test_in_wsl_the_browser_is_that_of_windows():
    assert "Windows" in notebook.browser({"PATH": "/nowhere"}, wsl=True).detail
