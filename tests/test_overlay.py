"""What colcon has installed, read as data: what sourcing would add, and whether it is made of the source."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from course_kit.setup.colcon import built, console_scripts, overlay, regular_files, sourcing
from course_kit.setup.environment.activation import PATH_VARIABLES, split_paths
from tests import packages

pytestmark = [pytest.mark.cpu_bound, pytest.mark.by_turns("builds of packages")]

LAYOUTS = {
    "apart": [],
    "merged": ["--merge-install"],
    "linked": ["--symlink-install"],
    "merged and linked": ["--merge-install", "--symlink-install"],
}
NAME = "demo_py"


@pytest.fixture(scope="module", params=LAYOUTS)
def original(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A workspace with demo_py, built in one of colcon's layouts."""
    workspace = tmp_path_factory.mktemp("overlay") / "ros2_ws"
    packages.add_python_package(workspace / "src")
    _build(workspace, *LAYOUTS[request.param])
    yield workspace
    shutil.rmtree(workspace)


@pytest.fixture
def workspace(original: Path) -> Iterator[Path]:
    """The same for one test, which may change it; links and .dsv files hold its path, so it keeps that."""
    kept = original.with_name("kept")
    shutil.copytree(original, kept, symlinks=True)
    yield original
    shutil.rmtree(original)
    kept.rename(original)


def _build(workspace: Path, *options: str) -> None:
    subprocess.run(["colcon", "build", *options], cwd=workspace, capture_output=True, check=True, timeout=60)


def _program(workspace: Path, name: str = "talker") -> Path:
    return overlay.prefix_of(workspace, NAME) / "lib" / NAME / name


def _fault(workspace: Path, name: str = "talker") -> str:
    return console_scripts.fault(workspace, NAME, _program(workspace, name))


def _installed(workspace: Path, module: str) -> Path:
    places = [path / NAME / module for path in built.module_paths(workspace)]
    return next(path for path in places if path.is_file())


def _edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.unlink()  # not what a link leads to
    path.write_text(text.replace(old, new))
    path.chmod(0o755)


def test_it_is_what_sourcing_adds(workspace: Path) -> None:
    before = {"PATH": os.environ["PATH"], "HOME": str(workspace)}
    after = sourcing.sourced(workspace / "install/setup.bash", before)
    for variable in PATH_VARIABLES:
        entries = [entry for entry in split_paths(after.get(variable, "")) if entry.startswith(str(workspace))]
        assert overlay.added(workspace).get(variable, []) == entries


def test_it_lies_behind_what_is_there(workspace: Path) -> None:
    paths = overlay.added(workspace)["PYTHONPATH"]
    assert overlay.over({"PYTHONPATH": "/own", "HOME": "/"}, workspace)["PYTHONPATH"].split(":") == ["/own", *paths]


def test_what_leads_out_of_the_workspace_is_not_taken(workspace: Path) -> None:
    share = overlay.prefix_of(workspace, NAME) / "share" / NAME
    hooks = share / "hook/more.dsv"
    hooks.write_text("prepend-non-duplicate;PATH;/elsewhere\nset;LD_PRELOAD;x.so\nprepend-non-duplicate;PATH;lib\n")
    with open(share / "package.dsv", "a") as package:
        package.write(f"source;share/{NAME}/hook/more.dsv\nsource;share/{NAME}/package.dsv\n")
    added = overlay.added(workspace)
    assert added["PATH"] == [str(overlay.prefix_of(workspace, NAME) / "lib")]
    assert "LD_PRELOAD" not in added


def test_what_was_built_is_accepted(workspace: Path) -> None:
    assert not built.is_made_by_hand(workspace, NAME)
    assert built.changed(workspace, NAME) == []
    assert [_fault(workspace, name) for name in ("talker", "listener")] == ["", ""]
    launch = overlay.prefix_of(workspace, NAME) / f"share/{NAME}/launch/demo.launch.py"
    assert built.comes_from_source(workspace, NAME, launch)


def test_what_was_not_built_again_is_found(workspace: Path) -> None:
    talker, launch = Path(f"src/{NAME}/{NAME}/talker.py"), Path(f"src/{NAME}/launch/demo.launch.py")
    is_linked = _installed(workspace, "talker.py").samefile(workspace / talker)
    for path in (talker, launch):
        (workspace / path).write_text((workspace / path).read_text() + "# more\n")
    assert built.changed(workspace, NAME) == ([] if is_linked else [workspace / path for path in (talker, launch)])


def test_what_was_changed_in_install_is_found(workspace: Path) -> None:
    _edit(_program(workspace), "sys.exit(", "print('Hi')\n    sys.exit(")
    assert "no program that setuptools makes" in _fault(workspace)
    module = _installed(workspace, "talker.py")
    if not module.samefile(workspace / f"src/{NAME}/{NAME}/talker.py"):
        _edit(module, "'chatter'", "'other'")
        assert built.changed(workspace, NAME) == [workspace / f"src/{NAME}/{NAME}/talker.py"]


def test_a_program_of_an_interpreter_of_its_own_is_found(workspace: Path) -> None:
    first = _program(workspace).read_text().splitlines()[0]
    _edit(_program(workspace), first, f"#!{workspace}/python3")
    assert "no program that setuptools makes" in _fault(workspace)


def test_an_entry_point_that_setup_py_lacks_is_found(workspace: Path) -> None:
    _edit(workspace / f"src/{NAME}/setup.py", "            'talker = demo_py.talker:main',\n", "")
    assert _fault(workspace) == f"src/{NAME}/setup.py has no entry point `talker`"
    assert _fault(workspace, "listener") == ""


def test_an_entry_point_that_setup_py_computes_is_none_that_it_lacks(workspace: Path) -> None:
    setup = workspace / f"src/{NAME}/setup.py"
    _edit(
        setup, "            'talker = demo_py.talker:main',\n", "            *[f'{n} = demo_py.{n}:main' for n in N],\n"
    )
    _edit(setup, "package_name =", "N = ['talk' + 'er']\npackage_name =")
    assert _fault(workspace) == ""


def test_a_module_that_the_source_lacks_is_found(workspace: Path) -> None:
    described = next(p for p in built.metadata(built.module_paths(workspace)) if (p / "entry_points.txt").is_file())
    _edit(described / "entry_points.txt", "demo_py.talker:main", "other:main")
    (built.module_paths(workspace)[0] / "other.py").write_text("def main(): pass\n")
    assert "is not one of src/demo_py" in _fault(workspace)


def test_what_is_no_regular_file_blocks_nothing(workspace: Path) -> None:
    source = workspace / "src" / NAME
    for path in (source / NAME / "fifo.py", source / "launch/fifo.launch.py"):
        os.mkfifo(path)
    (source / NAME / "zero.py").symlink_to("/dev/zero")
    assert built.changed(workspace, NAME) == []
    for path in (_program(workspace), next(overlay.prefix_of(workspace, NAME).glob(f"share/{NAME}/package.dsv"))):
        path.unlink()
        os.mkfifo(path)
    assert built.is_made_by_hand(workspace, NAME)
    assert "no file that can be read" in _fault(workspace)


def test_a_package_made_by_hand_is_found(tmp_path: Path) -> None:
    prefix = tmp_path / "install" / NAME
    packages.write(prefix, {f"lib/{NAME}/talker": "#!/bin/sh\n", f"share/colcon-core/packages/{NAME}": ""})
    assert built.is_made_by_hand(tmp_path, NAME)
    assert "no program that setuptools makes" in _fault(tmp_path)


def test_only_regular_files_of_bounded_size_are_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "long").write_bytes(b"x" * (regular_files.MAX_SIZE + 1))
    (tmp_path / "short").write_bytes(b"caf\xe9")
    unread = [tmp_path / "fifo", tmp_path / "long", tmp_path / "none", tmp_path, Path("/dev/zero")]
    assert [regular_files.text_of(path) for path in unread] == [None] * 5
    assert regular_files.text_of(tmp_path / "short") == "caf\ufffd"
    assert regular_files.are_same(tmp_path / "long", tmp_path / "long")
    assert sorted(path.name for path in regular_files.below(tmp_path)) == ["long", "short"]
