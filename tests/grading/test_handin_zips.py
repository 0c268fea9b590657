"""Zips that were handed in: unsafe names, bombs, damage; and whatever else may come."""

from __future__ import annotations

import io
import os
import random
import stat
import tempfile
import zipfile
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from course_kit.classroom.collect import handin_search, handin_zips
from course_kit.classroom.collect.handin_names import notebook_of, number_of, printable, sender_of
from course_kit.classroom.collect.handins import HandIn, find
from tests.grading.made_handins import MOODLE, NAMES, TOPICS, in_folder_and_zip, lay, topics, zipped

# Zips


@pytest.mark.parametrize(
    ("name", "why"),
    [
        (f"../../{TOPICS}", "leads out of it"),
        (f"a/../{TOPICS}", "leads out of it"),
        (f"/etc/{TOPICS}", "an absolute one"),
        (f"C:{TOPICS}", "an absolute one"),
        (f"C:\\x\\{TOPICS}", "an absolute one"),
        (f"..\\{TOPICS}", "leads out of it"),
        (f"sub\\{TOPICS}", "has backslashes"),
        (f"{'d/' * 40}{TOPICS}", "too deep"),
        (f"{'n' * 300}/{TOPICS}", "none of a file"),
    ],
)
def test_unsafe_names_in_a_zip(tmp_path: Path, name: str, why: str):
    content = {name: "bad", "01_setup_checks.ipynb": "good"}
    (found,) = find(lay(tmp_path / "one", {"alice.zip": zipped(content)}), NAMES)
    assert (found.student, found.notebooks) == ("alice", {"01_setup_checks.ipynb": b"good"})
    assert len(found.notes) == 1 and why in found.notes[0] and found.notes[0].isprintable()
    (tmp_path / "hw.zip").write_bytes(zipped({f"alice/{TOPICS}": "a", f"bob/{TOPICS}": "b", name: "bad"}))
    assert topics(find(tmp_path / "hw.zip", NAMES)) == {"alice": "a", "bob": "b"}  # and nobody new of this name
    assert any(why in note for each in find(tmp_path / "hw.zip", NAMES) for note in each.notes)
    assert sorted(os.listdir(tmp_path)) == ["hw.zip", "one"]


def test_an_unsafe_name_below_a_students_folder_is_told_of_her(tmp_path: Path):
    (tmp_path / "hw.zip").write_bytes(zipped({f"alice/../bob/{TOPICS}": "x", f"bob/{TOPICS}": "b"}))
    alice, bob = find(tmp_path / "hw.zip", NAMES)
    assert "alice/../bob/03_topics.ipynb was left out: its name in the zip leads out of it" in alice.notes[1]
    assert bob == HandIn("bob", {TOPICS: b"b"})


def only_notes(tmp_path: Path, data: bytes) -> str:
    """What is told of a student whose zip this is, and of which nothing counts."""
    (found,) = find(lay(tmp_path, {"alice/work.zip": data}), NAMES)
    assert (found.student, dict(found.notebooks)) == ("alice", {})
    return " | ".join(found.notes)


def patched(data: bytes, **fields: int) -> bytes:
    """A zip of one member with other values in both of its headers."""
    new = bytearray(data)
    for signature, places in ((b"PK\3\4", {"flags": 6, "size": 22}), (b"PK\1\2", {"flags": 8, "size": 24})):
        at = data.index(signature)
        for name, value in fields.items():
            length = 2 if name == "flags" else 4
            new[at + places[name] : at + places[name] + length] = value.to_bytes(length, "little")
    return bytes(new)


def test_zips_that_cannot_be_read(tmp_path: Path):
    fine = zipped({TOPICS: b"0123456789" * 50}, zipfile.ZIP_STORED)
    assert "no zip that can be read" in only_notes(tmp_path, b"")
    assert "no zip that can be read" in only_notes(tmp_path, fine[:-30])
    assert "03_topics.ipynb was left out: it is encrypted" in only_notes(tmp_path, patched(fine, flags=1))
    assert "it cannot be read (Bad CRC-32" in only_notes(tmp_path, fine.replace(b"0123", b"3210", 1))
    bzip2 = zipped({TOPICS: bytes(10_000)}, zipfile.ZIP_BZIP2)
    assert "its way of packing is not read (bzip2)" in only_notes(tmp_path, bzip2)
    link = zipfile.ZipInfo(TOPICS)
    link.external_attr = (stat.S_IFLNK | 0o777) << 16
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive:
        archive.writestr(link, "/etc/passwd")
    assert "links are not followed" in only_notes(tmp_path, data.getvalue())
    assert "of archives only zips are read" in " ".join(find(lay(tmp_path, {"alice/a.rar": ""}), NAMES)[0].notes)


def test_bombs(tmp_path: Path):
    declared = zipped({TOPICS: bytes(19_000_000)})
    assert "packed like a zip bomb (19.0 MB in 18,4" in only_notes(tmp_path, declared)
    too_big = zipped({TOPICS: random.Random(1).randbytes(20_000_001)}, zipfile.ZIP_STORED)
    assert "03_topics.ipynb was left out: it has 20.0 MB" in only_notes(tmp_path, too_big)
    real = patched(declared, size=1000)  # it says that it is small: no more is read
    assert "03_topics.ipynb was left out: it cannot be read" in only_notes(tmp_path, real)
    claimed = patched(zipped({TOPICS: b"x"}), size=0xFFFFFFF0)
    assert "packed like a zip bomb" in only_notes(tmp_path, claimed)


def test_limits_of_zips(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(handin_zips, "MAX_MEMBERS", 3)
    assert "holds more than 3 files" in only_notes(tmp_path, zipped({f"{n}.ipynb": "" for n in range(4)}))
    nested = zipped({"a.zip": zipped({TOPICS: "a" * 500}), "b.zip": zipped({TOPICS: "b" * 500})}, zipfile.ZIP_STORED)
    monkeypatch.setattr(handin_search, "MAX_ZIPS", 200)
    (found,) = find(lay(tmp_path, {"alice/work.zip": nested}), NAMES)
    assert found.notebooks == {TOPICS: b"a" * 500}
    assert found.notes == ("work.zip/b.zip was left out: the zips in zips have more than 200 bytes",)
    monkeypatch.setattr(handin_zips, "MAX_READ", 100)
    assert "table of contents is too long" in only_notes(tmp_path, zipped({f"{n * 80}": "" for n in range(3)}))


def test_zips_nest_once(tmp_path: Path):
    inner = zipped({TOPICS: "deep"})
    lay(tmp_path, {"alice.zip": zipped({"a.zip": inner}), "bob.zip": zipped({"b.zip": zipped({"c.zip": inner})})})
    alice, bob = find(tmp_path, NAMES)
    assert alice.notebooks == {TOPICS: b"deep"}
    assert "bob.zip/b.zip/c.zip was left out: zips are nested too deep" in bob.notes
    (tmp_path / "hw.zip").write_bytes(zipped({"alice.zip": inner, "bob.zip": zipped({"b.zip": inner})}))
    alice, bob = find(tmp_path / "hw.zip", NAMES)
    assert (alice.student, alice.notebooks) == ("alice", {TOPICS: b"deep"})
    assert "bob.zip/b.zip was left out: zips are nested too deep" in bob.notes


def test_a_damaged_zip_does_not_stop_the_class(tmp_path: Path):
    damaged = zipped({TOPICS: "x"})[:-9]
    files = {"alice.zip": damaged, "bob.zip": zipped({TOPICS: "b"}), f"cy_1_2_{TOPICS[:-6]}.zip": damaged}
    for found in in_folder_and_zip(tmp_path, files):
        assert [each.student for each in found] == ["alice", "bob", "cy"]
        assert topics(found) == {"bob": "b"}
        assert "alice.zip was left out: it is no zip that can be read" in found[0].notes[1]


def test_a_member_that_is_twice_in_a_zip(tmp_path: Path):
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w") as archive, pytest.warns(UserWarning, match="Duplicate"):
        archive.writestr(TOPICS, "first")
        archive.writestr(TOPICS, "second")
    (found,) = find(lay(tmp_path, {"alice.zip": data.getvalue()}), NAMES)
    assert found.notebooks == {TOPICS: b"second"}
    assert "more than once" in found.notes[0]


def test_files_are_closed(tmp_path: Path):
    lay(tmp_path, {f"{n}.zip": zipped({TOPICS: str(n)}) for n in range(100)})
    before = os.listdir("/proc/self/fd")
    assert len(find(tmp_path, NAMES)) == 100
    assert os.listdir("/proc/self/fd") == before


# Whatever comes


def test_the_order_of_folders_does_not_matter(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    files = {f"{who}/{week}/{TOPICS}": who + week for who in "cab" for week in "zxy"}
    files |= {f"{who}/{week}/ros2_ws/src/{name}": week for who in "ab" for week in "zx" for name in "qrp"}
    expected = find(lay(tmp_path, files | {"d.ipynb": "", "e_1_2_x.pdf": "", "f_2_1_y.pdf": ""}), NAMES)
    scandir = os.scandir

    class Shuffled:
        def __init__(self, path: str) -> None:
            with scandir(path) as found:
                self.entries = list(found)
            random.shuffle(self.entries)

        def __enter__(self) -> Any:
            return iter(self.entries)

        def __exit__(self, *_: object) -> None:
            pass

    monkeypatch.setattr(os, "scandir", Shuffled)
    for _ in range(10):
        found = find(tmp_path, NAMES)
        assert found == expected
        assert [list(each.workspace) for each in found] == [list(each.workspace) for each in expected]


FEW = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
PART = st.sampled_from(
    ["..", ".", "", "C:", "a", "b\\c", TOPICS, "ros2_ws", "src", "x.zip", "=1+1", "d\n", "Ü_1", "\x07"]
)
ZIP_NAME = st.one_of(
    st.lists(PART, min_size=1, max_size=6).map("/".join), st.text(min_size=1, max_size=20)
).filter(lambda name: not any("\ud800" <= c <= "\udfff" for c in name))  # fmt: skip


@FEW
@given(names=st.lists(ZIP_NAME, min_size=1, max_size=8, unique=True))
def test_any_names_in_zips_are_harmless(tmp_path: Path, names: list[str]):
    (tmp_path / "hw.zip").write_bytes(zipped({name: "x" for name in names}))
    try:
        found = find(tmp_path / "hw.zip", NAMES)
    except ValueError as error:
        assert "nobody has handed in" in str(error)
        return
    labels = [each.student for each in found]
    assert labels == sorted(set(labels)) and all(label.isprintable() and label for label in labels)
    assert all(note.isprintable() for each in found for note in each.notes)
    for path in (Path(path) for each in found for path in each.workspace):
        assert not path.is_absolute() and ".." not in path.parts
    assert os.listdir(tmp_path) == ["hw.zip"]


@FEW
@given(changes=st.lists(st.tuples(st.integers(0, 10_000), st.integers(0, 255)), min_size=1, max_size=12))
def test_any_damage_of_a_zip_is_survived(tmp_path: Path, changes: list[tuple[int, int]]):
    data = bytearray(zipped({f"alice/{TOPICS}": "a" * 100, "bob.zip": zipped({TOPICS: "b"})}))
    for place, value in changes:
        data[place % len(data)] = value
    # Each example has its own folder: the zip of another one, with a damaged date, may be newer than what cy has.
    folder = lay(Path(tempfile.mkdtemp(dir=tmp_path)), {f"cy/{TOPICS}": "c", "dee.zip": bytes(data)})
    found = find(folder, NAMES)
    assert topics(found)["cy"] == "c" and len(found) >= 2
    (folder / "dee.zip").replace(folder / "cy/dee.zip")
    assert [each.student for each in find(folder, NAMES)] == ["cy"]


@given(st.text(alphabet=st.characters(), max_size=400))
def test_anything_becomes_printable(text: str):
    shown = printable(text)
    assert shown and shown.isprintable() and len(shown) <= 100 and shown.encode()


@given(st.text(max_size=300), st.sampled_from(["", "_12_34_03_topics.ipynb", f"_5{MOODLE}"]))
def test_any_name_can_be_asked(text: str, end: str):
    sender_of(text + end)
    number_of(text + end)
    assert notebook_of(text + end, NAMES) in (None, *NAMES)
