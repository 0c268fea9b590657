"""Tells if setuptools has made an installed program of an entry point, and of which. Everything is read as data."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from course_kit.setup.colcon import regular_files
from course_kit.setup.colcon.built import comes_from_source, metadata, module_paths

SETUP_TIMEOUT = 20.0
SYSTEM_FOLDERS = ("/usr/bin", "/usr/local/bin", "/bin")
# What setuptools writes for an entry point; `spec` is the distribution, and its version if it is not linked.
SCRIPT = """
import re
import sys
__requires__ = {spec!r}
try:
    from importlib.metadata import distribution
except ImportError:
    try:
        from importlib_metadata import distribution
    except ImportError:
        from pkg_resources import load_entry_point
def importlib_load_entry_point(spec, group, name):
    dist_name, _, _ = spec.partition('==')
    matches = (
        entry_point
        for entry_point in distribution(dist_name).entry_points
        if entry_point.group == group and entry_point.name == name
    )
    return next(matches).load()
globals().setdefault('load_entry_point', importlib_load_entry_point)
if __name__ == '__main__':
    sys.argv[0] = re.sub(r'(-script\\.pyw?|\\.exe)?$', '', sys.argv[0])
    sys.exit(load_entry_point({spec!r}, 'console_scripts', {name!r})())
"""
# And what pip writes.
PIP_SCRIPT = """
import re
import sys
from {module} import {function}
if __name__ == '__main__':
    sys.argv[0] = re.sub(r'(-script\\.pyw|\\.exe)?$', '', sys.argv[0])
    sys.exit({function}())
"""
NEW_PIP_SCRIPT = """
import sys
from {module} import {function}
if __name__ == '__main__':
    if sys.argv[0].endswith('.exe'):
        sys.argv[0] = sys.argv[0][:-4]
    sys.exit({function}())
"""


def fault(workspace: Path, package: str, program: Path) -> str:
    """Why an installed program of a package is not made of its source; nothing if it is."""
    text = regular_files.text_of(program)
    if text is None:
        return "it is no file that can be read"
    first, _, rest = text.partition("\n")
    if _is_copied(workspace / "src" / package, rest):
        return ""
    targets = {target for one in metadata(module_paths(workspace)) for target in _targets(one, program.name)}
    if not (_is_python(first) and any(_is_made_for(rest, program.name, target) for target in targets)):
        return "it is no program that setuptools makes of an entry point"
    if not any(_has_module(workspace, package, target) for target in targets):
        return f"the module of its entry point ({', '.join(sorted(targets))}) is not one of src/{package}"
    if not any(_is_stated(workspace, package, program.name, target) for target in targets):
        return f"src/{package}/setup.py has no entry point `{program.name}`"
    return ""


def _is_copied(source: Path, text: str) -> bool:
    """Return True if setup.py names a file like this, but for the first line, in which setuptools names the Python."""
    named = {word.rpartition("/")[2] for word in _words(source)}
    same = [
        file for file in regular_files.below(source) if (regular_files.text_of(file) or "").partition("\n")[2] == text
    ]
    return bool(text) and any(file.name in named for file in same)


def _targets(described: Path, name: str) -> Iterator[str]:
    """The module and function of a program, as the description of an installed distribution has it."""
    section = ""
    for line in (regular_files.text_of(described / "entry_points.txt") or "").splitlines():
        if line.strip().startswith("["):
            section = line.strip()
        key, _, target = line.partition("=")
        if section == "[console_scripts]" and key.strip() == name:
            yield target.strip()


def _is_python(first: str) -> bool:
    """Return True if the first line of a program names this Python, or one of the system."""
    named = first.removeprefix("#!").strip()
    folder, _, name = named.rpartition("/")
    known = folder in SYSTEM_FOLDERS or os.path.realpath(folder) == os.path.realpath(os.path.join(sys.prefix, "bin"))
    return first.startswith("#!/") and (named == "/usr/bin/env python3" or (known and name.startswith("python")))


def _is_made_for(text: str, name: str, target: str) -> bool:
    """Return True if a program is what setuptools or pip writes for an entry point."""
    spec = re.search(r"^__requires__ = '([^'\\]*)'$", text, re.MULTILINE)
    module, _, function = target.partition(":")
    try:
        parsed = ast.dump(ast.parse(text))
        forms = [form.format(module=module, function=function) for form in (PIP_SCRIPT, NEW_PIP_SCRIPT)]
        forms += [SCRIPT.format(spec=spec[1], name=name)] if spec else []
        return any(parsed == ast.dump(ast.parse(form)) for form in forms)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return False


def _has_module(workspace: Path, package: str, target: str) -> bool:
    """Return True if the first module of this name that Python finds in the workspace is of the package's source."""
    place = Path(*target.partition(":")[0].split("."))
    candidates = [base / end for base in module_paths(workspace) for end in (f"{place}.py", place / "__init__.py")]
    found = next((path for path in candidates if path.is_file()), None)
    return found is not None and comes_from_source(workspace, package, found)


def _is_stated(workspace: Path, package: str, name: str, target: str) -> bool:
    """Return True if setup.py has the entry point: in so many words, or by what it computes."""
    source = workspace / "src" / package
    wanted = re.compile(rf"(?<![\w.-]){re.escape(name)}[\"']?\s*=\s*[\"']?\s*{re.escape(target)}(?![\w.])")
    if wanted.search("\n".join(_words(source))):
        return True
    return f"{name} = {target}" in _computed(source)


def _words(source: Path) -> Iterator[str]:
    """What the files say that setuptools reads."""
    yield from (regular_files.text_of(source / file) or "" for file in ("setup.cfg", "pyproject.toml"))
    try:
        tree = ast.parse(regular_files.text_of(source / "setup.py") or "")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return
    yield from (node.value for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str))


def _computed(source: Path) -> list[str]:
    """The entry points that setuptools finds when it runs setup.py, in a copy of the source."""
    with tempfile.TemporaryDirectory(prefix="course-kit-setup-") as work:
        for path in regular_files.below(source):
            target = Path(work, path.relative_to(source))
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(regular_files.data_of(path) or b"")
        try:
            command = [sys.executable, "setup.py", "-q", "egg_info", "--egg-base", "."]
            subprocess.run(
                command, cwd=work, stdin=subprocess.DEVNULL, capture_output=True, timeout=SETUP_TIMEOUT, check=True
            )
        except (OSError, subprocess.SubprocessError):
            return []
        texts = [regular_files.text_of(path / "entry_points.txt") or "" for path in metadata([Path(work)])]
        return [line.strip() for text in texts for line in text.splitlines()]
