"""`ros2 pkg`: what `create` prints and makes, that it can be built and runs; list, prefix, executables, xml."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from pathlib import Path

import pytest

from course_kit.cli.ros2.command import run
from course_kit.cli.ros2.pkg import create
from course_kit.ros import packages

WHO = ("--maintainer-name", "Nobody", "--maintainer-email", "nobody@nowhere.com")
LICENSES = "Apache-2.0\nBSL-1.0\nBSD-2.0\nBSD-2-Clause\nBSD-3-Clause\nGPL-3.0-only\nLGPL-3.0-only\nMIT\nMIT-0\n"
Printed = Callable[..., tuple[str, str]]


@pytest.fixture
def pkg(tmp_path, monkeypatch, capsys) -> Printed:
    """Runs a verb in an empty folder; gives what it printed to stdout and stderr."""
    monkeypatch.chdir(tmp_path)

    def printed(*words: str, status: int = 0) -> tuple[str, str]:
        assert run(["pkg", *words]) == status
        captured = capsys.readouterr()
        return captured.out, captured.err

    return printed


def made(name: str) -> list[str]:
    return sorted(str(path) for path in Path(name).rglob("*") if path.is_file())


def test_create_of_an_ament_python_package_says_what_the_real_one_says(pkg):
    options = ("--build-type", "ament_python", "--license", "Apache-2.0", "--node-name", "my_node")
    out, err = pkg("create", *options, *WHO, "my_package")
    assert err == ""
    assert out == (
        "going to create a new package\n"
        "package name: my_package\n"
        f"destination directory: {os.getcwd()}\n"
        "package format: 3\n"
        "version: 0.0.0\n"
        "description: TODO: Package description\n"
        "maintainer: ['Nobody <nobody@nowhere.com>']\n"
        "licenses: ['Apache-2.0']\n"
        "build type: ament_python\n"
        "dependencies: []\n"
        "node_name: my_node\n"
        "creating folder ./my_package\n"
        "creating ./my_package/package.xml\n"
        "creating source folder\n"
        "creating folder ./my_package/my_package\n"
        "creating ./my_package/setup.py\n"
        "creating ./my_package/setup.cfg\n"
        "creating folder ./my_package/resource\n"
        "creating ./my_package/resource/my_package\n"
        "creating ./my_package/my_package/__init__.py\n"
        "creating folder ./my_package/test\n"
        "creating ./my_package/test/test_copyright.py\n"
        "creating ./my_package/test/test_flake8.py\n"
        "creating ./my_package/test/test_pep257.py\n"
        "creating ./my_package/my_package/my_node.py\n"
    )
    announced = {line.split("creating ./")[1] for line in out.splitlines() if line.startswith("creating ./")}
    assert set(made("my_package")) == announced | {"my_package/LICENSE"}


def test_create_of_an_ament_cmake_package_says_what_the_real_one_says(pkg):
    out, err = pkg(
        *("create", "a_test_package", "--package-format", "3", "--license", "Apache-2.0"),
        *("--description", "A test package dummy description", "--build-type", "ament_cmake"),
        *("--dependencies", "rclpy", *WHO, "--node-name", "test_node", "--library-name", "test_library"),
    )
    assert err == ""
    assert out == (
        "going to create a new package\n"
        "package name: a_test_package\n"
        f"destination directory: {os.getcwd()}\n"
        "package format: 3\n"
        "version: 0.0.0\n"
        "description: A test package dummy description\n"
        "maintainer: ['Nobody <nobody@nowhere.com>']\n"
        "licenses: ['Apache-2.0']\n"
        "build type: ament_cmake\n"
        "dependencies: ['rclpy']\n"
        "node_name: test_node\n"
        "library_name: test_library\n"
        "creating folder ./a_test_package\n"
        "creating ./a_test_package/package.xml\n"
        "creating source and include folder\n"
        "creating folder ./a_test_package/src\n"
        "creating folder ./a_test_package/include/a_test_package\n"
        "creating ./a_test_package/CMakeLists.txt\n"
        "creating ./a_test_package/src/test_node.cpp\n"
        "creating ./a_test_package/include/a_test_package/test_library.hpp\n"
        "creating ./a_test_package/src/test_library.cpp\n"
        "creating ./a_test_package/include/a_test_package/visibility_control.h\n"
    )
    root = ElementTree.parse("a_test_package/package.xml").getroot()
    assert (root.tag, root.get("format")) == ("package", "3")
    assert [(child.tag, (child.text or "").strip()) for child in root] == [
        ("name", "a_test_package"),
        ("version", "0.0.0"),
        ("description", "A test package dummy description"),
        ("maintainer", "Nobody"),
        ("license", "Apache-2.0"),
        ("buildtool_depend", "ament_cmake_ros"),
        ("depend", "rclpy"),
        ("test_depend", "ament_lint_auto"),
        ("test_depend", "ament_lint_common"),
        ("export", ""),
    ]
    assert root.findtext("export/build_type") == "ament_cmake"


def test_without_a_license_it_warns_in_the_end_and_writes_none(pkg):
    out, _ = pkg("create", "plain", *WHO)
    assert out.endswith(
        "creating ./plain/CMakeLists.txt\n"
        "\n"
        "[WARNING]: Unknown license 'TODO: License declaration'.  This has been set in the package.xml, but no LICENSE "
        "file has been created.\n"
        "It is recommended to use one of the ament license identitifers:\n" + LICENSES
    )
    assert made("plain") == ["plain/CMakeLists.txt", "plain/package.xml"]
    assert "find_package(<dependency> REQUIRED)" in Path("plain/CMakeLists.txt").read_text()


def test_the_licenses_that_come_with_their_text(pkg):
    assert pkg("create", "any", "--license", "?") == (f"Supported licenses:\n{LICENSES}", "")
    assert os.listdir() == []
    beginnings = {name: (create.license_text(name) or "").strip().splitlines()[0] for name in LICENSES.split()}
    assert beginnings["Apache-2.0"].strip() == "Apache License"
    assert beginnings["GPL-3.0-only"].strip() == "GNU GENERAL PUBLIC LICENSE"
    assert beginnings["MIT"].startswith("Permission is hereby granted, free of charge")
    assert all(beginnings.values())
    pkg("create", "mine", "--license", "BSD-3-Clause")
    assert "Neither the name of the copyright holder" in Path("mine/LICENSE").read_text()


def test_a_package_that_is_there_is_not_touched(pkg):
    pkg("create", "twice", *WHO)
    before = Path("twice/package.xml").read_text()
    assert pkg("create", "twice", "--description", "another", status=1) == (
        "",
        "\nAborted!\nThe directory already exists: ./twice\nEither remove the directory or choose a different "
        "destination directory or package name\n",
    )
    assert Path("twice/package.xml").read_text() == before


def test_the_destination_may_be_elsewhere_and_new(pkg):
    out, _ = pkg("create", "far", "--destination-directory", "ws/src", *WHO)
    assert f"destination directory: {os.getcwd()}/ws/src\n" in out
    assert "creating folder ws/src/far\n" in out
    assert Path("ws/src/far/package.xml").is_file()


def test_a_destination_that_cannot_be_made_is_one_line(pkg):
    Path("file").write_text("")
    _, err = pkg("create", "far", "--destination-directory", "file", status=1)
    assert err == "unable to create file/far: Not a directory\n"


def test_a_node_and_a_library_of_one_name_are_told_apart(pkg):
    out, err = pkg("create", "lab", "--node-name", "same", "--library-name", "same", *WHO)
    assert err == "[WARNING] node name can not be equal to the library name\n[WARNING] renaming node to same_node\n"
    assert "node_name: same_node\nlibrary_name: same\n" in out
    assert {"lab/src/same.cpp", "lab/src/same_node.cpp"} <= set(made("lab"))


def test_an_ament_python_package_cannot_be_called_test(pkg):
    _, err = pkg("create", "test", "--build-type", "ament_python", status=1)
    assert err == (
        "Aborted since 'ament_python' packages can't be named 'test'. Please choose a different package name.\n"
    )


@pytest.mark.parametrize("name", ["a/b", "..", "/tmp/x"])
def test_a_name_that_is_a_path_is_refused(name, pkg):
    assert pkg("create", name, status=1) == ("", f"'{name}' cannot be the name of a folder or file\n")
    assert os.listdir() == []


def test_text_with_special_characters_reaches_the_files_unharmed(pkg):
    said = 'it\'s <b>"new"</b> & more'
    pkg("create", "odd", "--build-type", "ament_python", "--description", said, "--license", "A & B", *WHO)
    root = ElementTree.parse("odd/package.xml").getroot()
    assert (root.findtext("description"), root.findtext("license")) == (said, "A & B")
    asked = subprocess.run(
        [sys.executable, "setup.py", "--description"], cwd="odd", capture_output=True, text=True, timeout=60
    )
    assert asked.stdout.splitlines()[-1] == said, asked.stderr


def test_a_python_node_is_built_and_runs(pkg):
    options = ("--build-type", "ament_python", "--node-name", "hello", "--library-name", "parts")
    pkg("create", "greeter", *options, "--license", "MIT", "--dependencies", "rclpy", "std_msgs", *WHO)
    # What colcon runs for a package of this kind, into a prefix of its own.
    options = ("--single-version-externally-managed", "--record", "record")
    arguments = ["setup.py", "-q", "install", "--prefix", os.path.abspath("install"), *options]
    built = subprocess.run([sys.executable, *arguments], cwd="greeter", capture_output=True, text=True, timeout=100)
    assert built.returncode == 0, built.stderr
    program = Path("install/lib/greeter/hello")
    (modules,) = {path.parent.parent for path in Path("install/lib").rglob("greeter/hello.py")}
    environment = os.environ | {"PYTHONPATH": str(modules), "AMENT_PREFIX_PATH": os.path.abspath("install")}
    ran = subprocess.run([program], capture_output=True, text=True, env=environment, timeout=60)
    assert (ran.stdout, ran.returncode) == ("Hi from greeter.\n", 0), ran.stderr
    assert (modules / "greeter/parts/__init__.py").is_file()
    assert not list(Path("install").rglob("test_*.py"))


def test_an_installed_package_is_found_by_the_other_verbs(pkg, monkeypatch):
    index = Path("ws/share/ament_index/resource_index/packages")
    index.mkdir(parents=True)
    (index / "greeter").write_text("")
    program = Path("ws/lib/greeter/hello")
    program.parent.mkdir(parents=True)
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    (program.parent / "notes.txt").write_text("")
    monkeypatch.setenv("AMENT_PREFIX_PATH", os.path.abspath("ws"))
    prefix = os.path.abspath("ws")
    assert pkg("list") == ("greeter\n", "")
    assert pkg("prefix", "greeter") == (f"{prefix}\n", "")
    assert pkg("prefix", "--share", "greeter") == (f"{prefix}/share/greeter\n", "")
    assert pkg("executables") == pkg("executables", "greeter") == ("greeter hello\n", "")
    assert pkg("executables", "--full-path") == (f"{prefix}/lib/greeter/hello\n", "")
    assert pkg("xml", "greeter", status=1) == ("", "Package xml manifest not found\n")


@pytest.mark.parametrize("library", [None, "parts"])
def test_a_cpp_node_compiles_and_runs(library, pkg):
    compiler = shutil.which("c++")
    if compiler is None:
        pytest.skip("there is no C++ compiler")
    pkg("create", "greeter", "--node-name", "hello", *(("--library-name", library) if library else ()), *WHO)
    flags = ["-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Igreeter/include"]
    sources = sorted(str(path) for path in Path("greeter/src").iterdir())
    subprocess.run([compiler, *flags, *sources, "-o", "hello"], check=True, timeout=100)
    assert subprocess.run(["./hello"], capture_output=True, text=True).stdout == "hello world greeter package\n"


@pytest.mark.parametrize("options", [(), ("--node-name", "n"), ("--library-name", "l", "--node-name", "n")])
def test_a_package_for_plain_cmake_builds(options, pkg):
    cmake = shutil.which("cmake")
    if cmake is None or shutil.which("c++") is None:
        pytest.skip("there is no cmake or no C++ compiler")
    pkg("create", "plain", "--build-type", "cmake", *options, "--license", "Apache-2.0", *WHO)
    environment = {k: v for k, v in os.environ.items() if k != "CMAKE_TOOLCHAIN_FILE"}
    install = f"-DCMAKE_INSTALL_PREFIX={os.path.abspath('install')}"
    for arguments in (["-S", "plain", "-B", "build", install], ["--build", "build", "--target", "install"]):
        done = subprocess.run([cmake, *arguments], capture_output=True, text=True, env=environment, timeout=100)
        assert done.returncode == 0 and "Warning" not in done.stderr, done.stderr
    assert Path("install/share/plain/cmake/plainConfig.cmake").is_file()
    if options:
        environment["LD_LIBRARY_PATH"] = os.path.abspath("install/lib")
        ran = subprocess.run(["install/lib/plain/n"], capture_output=True, text=True, env=environment)
        assert ran.stdout == "hello world plain package\n"


def test_the_cmake_of_an_interface_package_finds_its_generators_and_the_linters_only_where_they_are(pkg):
    pkg("create", "iface", "--dependencies", "rosidl_default_generators", "std_msgs", *WHO)
    lines = Path("iface/CMakeLists.txt").read_text().splitlines()
    assert lines[lines.index("# find dependencies") + 1 :][:4] == [
        "find_package(ament_cmake REQUIRED)",
        "find_package(rosidl_default_generators REQUIRED)",
        "find_package(std_msgs REQUIRED)",
        "",
    ]
    assert "  find_package(ament_lint_auto QUIET)" in lines


def test_every_place_of_every_template_is_filled():
    package = create.Package("a", "cmake", 3, "d", "m", "e", "l", ("x", "y"), "n", "b")
    files = list(create.TEMPLATES.rglob("*.template"))
    assert len(files) > 5
    for file in files:
        name = str(file.relative_to(create.TEMPLATES)).removesuffix(".template")
        assert not any(mark in package.filled(name) for mark in ("[[", "{%")), name


def test_the_manifest_is_xml_whatever_the_words_in_it():
    odd = """<"a" & 'b'>"""
    package = create.Package("a", "ament_python", 3, odd, odd, odd, odd)
    root = ElementTree.fromstring(package.filled("package.xml"))
    assert [root.findtext(tag) for tag in ("description", "maintainer", "license")] == [odd] * 3
    assert root.find("maintainer").get("email") == odd


def test_the_verbs_know_every_installed_package(pkg):
    names = packages.package_names()
    assert pkg("list")[0].split() == names and {"rclpy", "turtlesim"} <= set(names)
    for name in names:
        pkg("prefix", name)
        pkg("executables", name)
    assert pkg("xml", "std_msgs", "-t", "name")[0] == "std_msgs\n"
    out, _ = pkg("xml", "std_msgs")
    assert ElementTree.fromstring(out).findtext("name") == "std_msgs"
    assert out.endswith("</package>\n")


@pytest.mark.parametrize(
    ("words", "err"),
    [
        (("prefix", "nope"), "Package not found\n"),
        (("prefix", "--share", "nope"), "Package not found\n"),
        (("prefix", "turtlsim"), "Package not found\nDid you mean turtlesim?\n"),
        (("xml", "nope"), "Package not found\n"),
        (("xml", "std_msgs", "-t", "nope"), "XML tag not found\n"),
        (("executables", "nope"), "Package 'nope' not found\n"),
    ],
)
def test_errors_are_those_of_the_real_command(words, err, pkg):
    assert pkg(*words, status=1) == ("", err)
