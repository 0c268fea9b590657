"""Answers to workspace-1: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked
from tests.exercises.workspace.cells import PYTHON

GREETER = f"""
fresh("greeter", {PYTHON})
build("greeter")
"""
IN_PLACE = changed(GREETER, ('build("greeter")', 'build("greeter", "--symlink-install")'))
MERGED = f"""
fresh("greeter", {PYTHON})
for part in ("build", "install"):
    shutil.rmtree(ws.folder / part, ignore_errors=True)
ws.build("--merge-install")
ws.use()
"""
# A module that is not called as the package, below a folder of its own, and programs that setup.py computes.
OTHER_MODULE = f"""
fresh("greeter", {PYTHON})
made, setup_py = ws.src / "greeter", ws.src / "greeter/setup.py"
(made / "source").mkdir()
shutil.move(made / "greeter", made / "source/polite")
(made / "source/polite/words").mkdir()
(made / "source/polite/words/__init__.py").write_text("NAME = __name__.split('.')[0].replace('polite', 'greeter')\\n")
(made / "source/polite/greet.py").write_text(
    "from polite.words import NAME\\n\\n\\ndef main():\\n    print(f'Hi from {{NAME}}.')\\n"
)
found = "find_packages('source'), package_dir={{'': 'source'}}"
text = setup_py.read_text().replace("find_packages(exclude=['test'])", found)
start, end = text.index("'console_scripts': ["), text.index("],", text.index("'console_scripts': ["))
programs = "[f'{{name}} = polite.{{name}}:main' for name in ('gre' + 'et',)"
setup_py.write_text(text[:start] + "'console_scripts': " + programs + text[end:])
build("greeter")
"""
# No build: a package in install by hand, and a set-up script that leads to a false `ros2`.
BY_HAND = f"""
fresh("greeter", {PYTHON})
install, false = ws.install / "greeter", ws.folder / "false"
for folder in ("lib/greeter", "share/greeter", "share/ament_index/resource_index/packages"):
    (install / folder).mkdir(parents=True)
shutil.copy(ws.src / "greeter/package.xml", install / "share/greeter")
(install / "share/ament_index/resource_index/packages/greeter").touch()
false.mkdir(exist_ok=True)
for path in (install / "lib/greeter/greet", false / "ros2"):
    path.write_text("#!/bin/sh\\necho Hi from greeter.\\n")
    path.chmod(0o755)
with open(ws.install / "setup.bash", "a") as script:
    script.write(f"export PATH={{false}}:$PATH\\n")
"""
SAYS_TWICE = changed(
    GREETER,
    (
        'build("greeter")',
        'source = ws.src / "greeter/greeter/greet.py"\n'
        'source.write_text(source.read_text().replace("    print(", "    print(1)\\n    print("))\n'
        'build("greeter")',
    ),
)
SHELL_SCRIPT = f"""{GREETER}
(ws.install / "greeter/lib/greeter/greet").write_text("#!/bin/sh\\necho Hi from greeter.\\n")
"""
EDITED_INSTALLED = f"""
fresh("greeter", {PYTHON})
source = ws.src / "greeter/greeter/greet.py"
source.write_text(source.read_text().replace("Hi from greeter.", "Hello."))
build("greeter")
installed = next(ws.install.glob("greeter/lib/python3*/site-packages/greeter/greet.py"))
installed.write_text(installed.read_text().replace("Hello.", "Hi from greeter."))
"""

ANSWERS = Answers(
    "workspace-1",
    2,
    f"leave_out('greeter')\n{worked('workspace-1')}",
    [
        Wrong("not_built", changed(GREETER, ('build("greeter")\n', "")), 0, "colcon build --packages-select"),
        Wrong(
            "built_in_src",
            changed(
                GREETER,
                (
                    'build("greeter")',
                    'subprocess.run(["colcon", "build"], cwd=ws.src, capture_output=True)',
                ),
            ),
            0,
            "you built in `src`",
        ),
        Wrong(
            "program",
            "for made in ('build', 'install', 'log'): shutil.rmtree(ws.src / made, ignore_errors=True)\n"
            + changed(GREETER, ('"greet")', '"hello")')),
            1,
            "finds hello in greeter",
        ),
        Wrong(
            "build_type",
            changed(GREETER, ('"ament_python"', '"ament_cmake"')),
            0,
            "make it anew with `--build-type ament_python`",
        ),
        Wrong("by_hand", BY_HAND, 0, "was not built from `src`"),
        Wrong("shell_script", SHELL_SCRIPT, 1, "no program that setuptools makes of an entry point"),
        Wrong("says_twice", SAYS_TWICE, 1, "in one line"),
        Wrong("edited_installed", EDITED_INSTALLED, 1, "what is installed was changed by hand"),
    ],
    {"in_place": IN_PLACE, "merged": MERGED, "other_module": OTHER_MODULE},
)
