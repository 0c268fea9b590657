"""`ros2 interface`: definitions as the real command shows them, for every type that is installed, and its errors."""

from __future__ import annotations

import io
import os
import re
from pathlib import Path
from typing import Any

import pytest
from rosidl_adapter.parser import parse_message_string  # type: ignore[import-untyped]

from course_kit.cli.ros2.command import run
from course_kit.cli.ros2.interface import interface, text
from course_kit.cli.ros2.line_completion import complete

pytestmark = pytest.mark.by_turns("hundreds of types", of="cases")

TRANSCRIPTS = Path(__file__).with_name("ros2_transcripts")
MODES = {(): (True, False), ("--all-comments",): (True, True), ("--no-comments",): (False, False)}

DEFINITIONS = {
    "msg/Inner.msg": "# What is inside\n\n"
    "uint8 SMALL=1   # the least\n"
    'string NAME="a"\n'
    "float64 x 1.5 # metres\n"
    "string<=5[<=3] words\n",
    "msg/Outer.msg": "#\n# Two of them\n#\n"
    "Inner  first # one\n"
    "Inner[] rest\n"
    "std_msgs/Header header\n"
    "  # indented\n"
    "int32[3] sizes [1, 2, 3]\n",
    "srv/Ask.srv": "Inner of\n---\nbool ok true # yes\n",
    "msg/Broken.msg": "nowhere/Thing thing\n",
    "msg/OnlyIdl.idl": "module lab {\n  struct OnlyIdl { long x; };\n};\n",
}
HEADER = "\tbuiltin_interfaces/Time stamp\n\t\tint32 sec\n\t\tuint32 nanosec\n\tstring frame_id\n"


@pytest.fixture
def lab(tmp_path, monkeypatch) -> str:
    """A package of its own with odd definitions, before the installed ones."""
    index = tmp_path / "share/ament_index/resource_index"
    listing = "".join(f"{name}\n" for name in [*DEFINITIONS, "msg/Hidden_Part.msg"])
    for name, content in (("packages/lab", ""), ("packages/bare", ""), ("rosidl_interfaces/lab", listing)):
        (index / name).parent.mkdir(parents=True, exist_ok=True)
        (index / name).write_text(content)
    for name, content in DEFINITIONS.items():
        path = tmp_path / "share/lab" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path}{os.pathsep}{os.environ['AMENT_PREFIX_PATH']}")
    return str(tmp_path)


def printed(capsys, *words: str, status: int = 0) -> tuple[str, str]:
    assert run(["interface", *words]) == status
    captured = capsys.readouterr()
    return captured.out, captured.err


def as_the_real_command(type_name: str, comments: bool, nested_comments: bool, depth: int = 0) -> list[str]:
    """What the real command prints, computed its way: each line alone goes through rosidl's own parser."""
    lines: list[str] = []
    package, _, name = type_name.split("/")
    for raw in Path(interface.path(type_name)).read_text().splitlines():
        text = raw.rstrip()
        message = None if text == "---" else parse_message_string(package, name, text)
        field: Any = next(iter([*message.fields, *message.constants]), None) if message else None
        is_comment = bool(message and message.annotations["comment"])
        trailing = field.annotations["comment"] if field else []
        if comments or (text and not is_comment):
            shown = text[: text.find(trailing[0]) - 1].strip() if trailing and not comments else text
            lines.append("\t" * depth + shown if shown else "")
        if message and message.fields and "/" in str(field.type):
            nested = str(field.type).split("[")[0].replace("/", "/msg/")
            lines += as_the_real_command(nested, nested_comments, nested_comments, depth + 1)
    return lines


@pytest.mark.parametrize("path", sorted(TRANSCRIPTS.glob("interface-*.txt")), ids=lambda path: path.stem)
def test_recordings_are_reproduced_whole(path, capsys):
    first, *rest, last = path.read_text().splitlines(keepends=True)
    marker = rest.index("# stderr:\n") if "# stderr:\n" in rest else len(rest)
    words = first.removeprefix("$ ros2 interface ").split()
    out, err = printed(capsys, *words, status=int(last.rsplit(" ", 1)[1]))
    if words[1].startswith("example_interfaces/"):  # the course's own definitions may have comments
        out = re.sub(r" *#.*", "", re.sub(r"^#.*\n", "", out, flags=re.MULTILINE))
    assert (out, err) == ("".join(rest[:marker]), "".join(rest[marker + 1 :]))


@pytest.mark.parametrize("type_name", interface.types())
def test_every_installed_type_is_shown_as_the_real_command_shows_it(type_name, capsys):
    for options, (comments, nested_comments) in MODES.items():
        out, _ = printed(capsys, "show", type_name, *options)
        assert out.splitlines() == as_the_real_command(type_name, comments, nested_comments)


@pytest.mark.parametrize("type_name", interface.types())
def test_every_installed_type_has_a_prototype(type_name, capsys):
    import yaml  # type: ignore[import-untyped]

    quoted, _ = printed(capsys, "proto", type_name)
    bare, _ = printed(capsys, "proto", type_name, "--no-quotes")
    assert quoted == f'"{bare[:-1]}"\n'
    assert isinstance(yaml.safe_load(bare), dict)


def test_there_are_types_of_each_kind_to_test_with():
    assert min(len(interface.types([kind])) for kind in text.KINDS) >= 2
    assert len(interface.types()) > 150


def test_constants_defaults_and_bounds_are_shown_below_the_field_that_has_them(lab, capsys):
    inner = '\tuint8 SMALL=1   #\n\tstring NAME="a"\n\tfloat64 x 1.5 #\n\tstring<=5[<=3] words\n'
    out, _ = printed(capsys, "show", "lab/msg/Outer")
    assert out == (
        f"#\n# Two of them\n#\nInner  first # one\n{inner}Inner[] rest\n{inner}std_msgs/Header header\n{HEADER}"
        "  # indented\nint32[3] sizes [1, 2, 3]\n"
    )
    out, _ = printed(capsys, "show", "lab/msg/Outer", "--no-comments")
    assert out == (
        f"#\n#\nInner  first #\n{inner}Inner[] rest\n{inner}std_msgs/Header header\n{HEADER}"
        "  # indented\nint32[3] sizes [1, 2, 3]\n"
    )
    out, _ = printed(capsys, "show", "lab/srv/Ask", "--all-comments")
    assert out == (
        "Inner of\n\t# What is inside\n\n\tuint8 SMALL=1   # the least\n"
        '\tstring NAME="a"\n\tfloat64 x 1.5 # metres\n\tstring<=5[<=3] words\n---\nbool ok true # yes\n'
    )


def test_a_definition_in_idl_is_shown_as_it_is(lab, capsys):
    assert printed(capsys, "show", "lab/msg/OnlyIdl") == (DEFINITIONS["msg/OnlyIdl.idl"], "")


def test_a_field_of_a_type_that_is_not_installed_ends_it_with_one_line(lab, capsys):
    out, err = printed(capsys, "show", "lab/msg/Broken", status=1)
    assert (out, err) == ("nowhere/Thing thing\n", "Unknown package 'nowhere'\n")


def test_the_type_is_read_from_stdin(monkeypatch, capsys):
    monkeypatch.setattr("sys.stdin", io.StringIO("std_msgs/msg/Bool\n"))
    assert printed(capsys, "show", "-")[0] == printed(capsys, "show", "std_msgs/msg/Bool")[0] != ""


def test_nothing_on_stdin_is_a_wrong_command_line(monkeypatch, capsys):
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    with pytest.raises(SystemExit, match="2"):
        run(["interface", "show", "-"])
    assert capsys.readouterr().err.endswith("error: the passed value is empty\n")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("nope/msg/Nope", "Unknown package 'nope'\n"),
        ("geometry_msg/msg/Twist", "Unknown package 'geometry_msg'\nDid you mean geometry_msgs/msg/Twist?\n"),
        ("geometry_msg/msg/Nope", "Unknown package 'geometry_msg'\nDid you mean geometry_msgs?\n"),
        ("std_msgs/String", "Invalid name 'std_msgs/String'. {}\nDid you mean std_msgs/msg/String?\n"),
        ("Twist", "Invalid name 'Twist'. {}\nDid you mean geometry_msgs/msg/Twist?\n"),
        ("std_msgs//String", "Invalid name 'std_msgs//String'. Must not contain empty parts\nDid you mean {}?\n"),
        ("std_msgs/../String", "Invalid name 'std_msgs/../String'. Must not contain '..'\nDid you mean {}?\n"),
    ],
)
def test_a_wrong_name_is_told_with_the_one_that_is_meant(name, message, capsys):
    middle = "std_msgs/msg/String" if "mean {}" in message else "Expected three parts separated by '/'"
    assert printed(capsys, "show", name, status=1) == ("", message.format(middle))


@pytest.mark.parametrize("verb", ["show", "proto"])
def test_a_misspelt_type_of_a_known_package(verb, lab, capsys):
    out, err = printed(capsys, verb, "lab/msg/Innr", status=1)
    assert out == ""
    assert err == f"Could not find the interface '{lab}/share/lab/msg/Innr.idl'\nDid you mean lab/msg/Inner?\n"


def test_a_prototype_needs_the_python_code_of_a_type(lab, capsys):
    out, err = printed(capsys, "proto", "lab/msg/Inner", status=1)
    assert (out, err) == ("", "lab/msg/Inner is installed without its Python code\n")


def test_a_prototype_is_that_of_the_part_which_a_caller_fills_in(capsys):
    assert printed(capsys, "proto", "example_interfaces/srv/AddTwoInts") == ('"a: 0\nb: 0\n"\n', "")
    assert printed(capsys, "proto", "example_interfaces/action/Fibonacci", "--no-quotes") == ("order: 0\n\n", "")
    assert printed(capsys, "proto", "std_msgs/Int32") == ('"data: 0\n"\n', "")


def test_list_has_a_heading_for_each_kind_and_hides_parts(lab, capsys):
    out, _ = printed(capsys, "list")
    headings = [line for line in out.splitlines() if not line.startswith("    ")]
    assert headings == ["Messages:", "Services:", "Actions:"]
    assert [line.strip() for line in out.splitlines() if line not in headings] == [
        name for kind in text.KINDS for name in interface.types([kind])
    ]
    assert "    lab/msg/Outer\n" in out and "Hidden" not in out
    messages, services, actions = (printed(capsys, "list", option)[0] for option in ("-m", "-s", "-a"))
    assert messages + services + actions == out
    assert printed(capsys, "list", "--only-actions", "--only-srvs")[0] == services + actions


def test_package_names_the_types_of_a_package(lab, capsys):
    assert (
        printed(capsys, "package", "std_srvs")[0] == "std_srvs/srv/Empty\nstd_srvs/srv/SetBool\nstd_srvs/srv/Trigger\n"
    )
    assert printed(capsys, "package", "lab", "-s")[0] == "lab/srv/Ask\n"
    assert printed(capsys, "package", "bare") == ("", "")
    assert printed(capsys, "package", "std_srv", status=1) == (
        "",
        "Unknown package 'std_srv'\nDid you mean std_srvs?\n",
    )


def test_packages_names_those_that_have_a_kind(lab, capsys):
    everything = printed(capsys, "packages")[0].split()
    assert everything == sorted(everything) and "lab" in everything and "bare" not in everything
    assert printed(capsys, "packages", "-a")[0] == "example_interfaces\nnav2_msgs\ntf2_msgs\nturtlesim\n"
    assert "std_srvs" not in printed(capsys, "packages", "-m")[0].split()


def test_tab_offers_types_and_packages(lab):
    offered = ["lab/msg/Broken", "lab/msg/Inner", "lab/msg/OnlyIdl", "lab/msg/Outer"]
    assert complete("interface show lab/m") == offered
    assert complete("interface package la") == ["lab"]
