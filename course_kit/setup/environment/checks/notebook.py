"""Checks of JupyterLab: the server, the kernel, the widgets, a browser to look at it."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Mapping
from pathlib import Path

from course_kit.setup.environment.checks.python import RENEW
from course_kit.setup.environment.interpreter import Interpreter
from course_kit.setup.environment.report import Check, fail, passed

# Name on PyPI -> where its JavaScript is, below share/jupyter/labextensions.
WIDGETS = {"ipywidgets": "@jupyter-widgets/jupyterlab-manager", "anywidget": "anywidget"}
START = "0_start.ipynb"  # the page that the course is opened with, in notebooks/; no chapter, as its number says
BROWSERS = ("xdg-open", "x-www-browser", "firefox", "google-chrome", "chromium", "chromium-browser")


def jupyterlab(python: Interpreter) -> Check:
    """JupyterLab and the kernel that runs the cells."""
    missing = [package for package in ("jupyterlab", "ipykernel") if package not in python.distributions]
    if not Path(python.prefix, "share/jupyter/kernels/python3/kernel.json").exists():
        missing.append("the kernel python3")
    if missing:
        return fail(f"{' and '.join(missing)} missing in {python.prefix}", "the notebooks run in it", RENEW)
    versions = python.distributions
    return passed(f"{versions['jupyterlab']}, ipykernel {versions['ipykernel']}")


def widgets(python: Interpreter) -> Check:
    """The Python and the browser's half of the widgets that draw the turtle."""
    extensions = Path(python.prefix, "share/jupyter/labextensions")
    missing = [
        package
        for package, folder in WIDGETS.items()
        if package not in python.distributions or not (extensions / folder / "package.json").exists()
    ]
    if missing:
        reason = "without them the turtle and its buttons show as plain text"
        return fail(f"{' and '.join(missing)} missing in {python.prefix}", reason, RENEW)
    return passed(", ".join(f"{package} {python.distributions[package]}" for package in WIDGETS))


def has_browser(environ: Mapping[str, str]) -> bool:
    """Return True if a browser can open a window here."""
    if environ.get("BROWSER"):
        return True
    screen = environ.get("DISPLAY") or environ.get("WAYLAND_DISPLAY")
    return bool(screen) and any(shutil.which(name, path=environ.get("PATH")) for name in BROWSERS)


def browser(environ: Mapping[str, str], wsl: bool = False) -> Check:
    """None is needed on this machine: any browser that reaches it will do."""
    if wsl:
        return passed("that of Windows: ./environment-check.sh lab prints the address to open there")
    if has_browser(environ):
        return passed("JupyterLab will open in it")
    return passed("none here: ./environment-check.sh lab prints the address to open")


if __name__ == "__main__":  # environment-check.sh asks whether there is a browser to open
    sys.exit(not has_browser(os.environ))
