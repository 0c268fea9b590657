"""How the answers to chapter 2's exercises make their packages and build them."""

from __future__ import annotations

PYTHON = '"--build-type", "ament_python", "--node-name", "greet"'  # of `ros2 pkg create`
PREPARE = r'''
import subprocess


def merged_no_more():
    for part in ("build", "install"):
        shutil.rmtree(ws.folder / part, ignore_errors=True)
    ws.build("--packages-select", "my_first_pkg")


def leave_out(name):
    """Have no package of that name, and folders of their own for the others."""
    if (ws.install / ".colcon_install_layout").read_text().strip() == "merged":
        merged_no_more()
    for part in ("src", "build", "install"):
        shutil.rmtree(ws.folder / part / name, ignore_errors=True)


def make(name, *options):
    """Make a package anew."""
    leave_out(name)
    command = ["ros2", "pkg", "create", name, "--license", "Apache-2.0", *options]
    subprocess.run(command, cwd=ws.src, check=True, capture_output=True)


def fresh(name, *options, programs=(), files={}):
    """Make a package anew, with these programs and files."""
    make(name, *options)
    made, setup_py = ws.src / name, ws.src / name / "setup.py"
    for program in programs:
        add_line(setup_py, "'console_scripts': [", f"            '{program} = {name}.{program}:main',")
    if setup_py.is_file():
        for folder in sorted({path.split("/")[0] for path in files} & {"launch", "config"}):
            line = f"        ('share/' + package_name + '/{folder}', __import__('glob').glob('{folder}/*')),"
            add_line(setup_py, "        ('share/' + package_name, ['package.xml']),", line)
    for path, text in files.items():
        (made / path).parent.mkdir(parents=True, exist_ok=True)
        (made / path).write_text(text)


def build(*names):
    ws.build("--packages-select", *names)
    ws.use()


def interfaces(battery, recharge):
    """Build robot_interfaces with these definitions, unless it is built with them."""
    files = {"msg/Battery.msg": battery, "srv/Recharge.srv": recharge}
    made = ws.src / "robot_interfaces"
    if (ws.install / "robot_interfaces").is_dir() and all((made / f).read_text() == t for f, t in files.items()):
        return
    lines = "find_package(rosidl_default_generators REQUIRED)\nrosidl_generate_interfaces(${PROJECT_NAME}\n"
    lines += '  "msg/Battery.msg" "srv/Recharge.srv")\nament_export_dependencies(rosidl_default_runtime)\n'
    fresh("robot_interfaces", "--build-type", "ament_cmake", files=files)
    add_line(made / "CMakeLists.txt", "find_package(ament_cmake REQUIRED)", lines)
    group = "  <buildtool_depend>rosidl_default_generators</buildtool_depend>\n"
    group += "  <member_of_group>rosidl_interface_packages</member_of_group>"
    add_line(made / "package.xml", "  <buildtool_depend>ament_cmake</buildtool_depend>", group)
    build("robot_interfaces")
'''
