"""A notebook under nbval, and once more in the same kernel: there a browser runs it.

`python -m tests.second_run NOTEBOOK`: pytest with nbval, and after the last cell JupyterLab opens the notebook, with
nbval's kernel in place of one of its own. What the browser and its server keep goes beside the notebook's folder.
"""

from __future__ import annotations

import json
import os
import shutil
import sys
import urllib.request
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from nbval.plugin import IPyNbFile

from tests.lab import browser, server

TIMEOUT = 400.0  # seconds; some cells build packages
OPTIONS = ("--nbval", "-q", "-p", "no:cacheprovider")


class InTheBrowser(pytest.Item):
    """All cells of a notebook, run from JupyterLab's menu."""

    parent: IPyNbFile

    def runtest(self) -> None:
        work = self.path.parents[1] / "lab"
        kernels = work / "kernels"
        kernels.mkdir(parents=True)
        shutil.copy(self.parent.kernel.km.connection_file, kernels)
        options = "--ServerApp.allow_external_kernels=True", f"--ServerApp.external_connection_dir={kernels}"
        with server(self.path.parent, work / "config", *options) as address:
            use_the_kernel(address, self.path.name)
            with browser(address, work / "profile") as lab:
                lab.open(self.path.name)
                lab.run_all(TIMEOUT)
                # With a text: pytest tells no values of an assert in this module.
                assert not (errors := lab.errors()), errors
                assert not lab.outside, lab.outside

    def reportinfo(self) -> tuple[Path, int, str]:
        return self.path, 0, self.name


def use_the_kernel(address: str, notebook: str) -> None:
    """Have the only kernel that the server knows be the notebook's."""
    parts = urlsplit(address)

    def ask(what: str, **body: object) -> Any:
        request = urllib.request.Request(
            f"http://{parts.netloc}/api/{what}",
            data=json.dumps(body).encode() if body else None,
            headers={"Authorization": parts.query.replace("=", " ")},  # token …
        )
        with urllib.request.urlopen(request, timeout=30) as response:
            return json.load(response)

    (kernel,) = ask("kernels")
    ask("sessions", path=notebook, name=notebook, type="notebook", kernel={"id": kernel["id"]})


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """After the last cell, while nbval's kernel still runs."""
    notebook = items[-1].parent
    assert notebook is not None
    items.append(InTheBrowser.from_parent(notebook, name="once more, in the browser"))


def main() -> int:
    notebook = Path(sys.argv[1])
    place = f"--rootdir={notebook.parent}", "-c", os.devnull
    return int(pytest.main([*place, *OPTIONS, str(notebook)], plugins=[sys.modules[__name__]]))


if __name__ == "__main__":
    sys.exit(main())
