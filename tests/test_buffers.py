"""The bounded buffer of a recording: order, bounds, what goes first, and snapshots that stay as they were."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from course_kit.lab.recordings.buffers import MessageBuffer

# A busy machine is no reason to fail.
patient = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
payloads = st.lists(st.binary(max_size=400), max_size=300)


def filled(messages: list[bytes], max_bytes: int = 1 << 30, keep: int | None = None) -> MessageBuffer:
    buffer = MessageBuffer(["/a"], max_bytes, keep)
    append = buffer.appender("/a")
    for number, message in enumerate(messages):
        append(message, number)
    return buffer


@patient
@given(payloads)
def test_everything_is_kept_in_order_while_there_is_room(messages: list[bytes]) -> None:
    kept = filled(messages).snapshot("/a")
    assert list(kept) == messages
    assert [kept[i] for i in range(len(kept))] == messages
    assert kept.receive_ns.tolist() == list(range(len(messages)))
    assert kept.sizes.tolist() == [len(m) for m in messages]
    assert kept.dropped == 0


@patient
@given(payloads, st.integers(2048, 20_000))
def test_a_full_buffer_drops_the_oldest_and_counts_them(messages: list[bytes], max_bytes: int) -> None:
    buffer = MessageBuffer(["/a"], max_bytes)
    append = buffer.appender("/a")
    for number, message in enumerate(messages):
        append(message, number)
        assert buffer.nbytes <= max_bytes
        kept = buffer.snapshot("/a")
        assert kept.dropped + len(kept) == number + 1
        assert buffer.counts("/a") == (len(kept), kept.dropped)
        assert list(kept) == messages[kept.dropped : number + 1]  # the newest, without a gap
        assert kept.receive_ns.tolist() == list(range(kept.dropped, number + 1))


def test_a_full_buffer_uses_most_of_its_room() -> None:
    buffer = filled([bytes(1000)] * 5000, max_bytes=1_000_000)
    assert sum(buffer.snapshot("/a").sizes) > 700_000


@patient
@given(payloads, st.integers(1, 40))
def test_keep_holds_exactly_the_last_messages(messages: list[bytes], keep: int) -> None:
    kept = filled(messages, keep=keep).snapshot("/a")
    assert list(kept) == messages[-keep:]
    assert kept.dropped == max(0, len(messages) - keep)
    assert filled(messages, keep=keep).counts("/a") == (len(kept), kept.dropped)


def test_keep_frees_the_memory_of_what_goes() -> None:
    buffer = filled([bytes(1000)] * 20_000, keep=10)
    assert buffer.nbytes < 10_000_000


@patient
@given(payloads, payloads)
def test_a_snapshot_does_not_change(before: list[bytes], after: list[bytes]) -> None:
    buffer = MessageBuffer(["/a"], 8192)
    append = buffer.appender("/a")
    for message in before:
        append(message, 1)
    kept = buffer.snapshot("/a")
    was = list(kept)
    for message in after:
        append(message, 2)
    assert list(kept) == was and set(kept.receive_ns.tolist()) <= {1}


@patient
@given(st.lists(st.tuples(st.sampled_from(["/a", "/b", "/c"]), st.binary(max_size=500)), max_size=300))
def test_topics_share_the_room(arrivals: list[tuple[str, bytes]]) -> None:
    buffer = MessageBuffer(["/a", "/b", "/c"], 10_000)
    append = {topic: buffer.appender(topic) for topic in ("/a", "/b", "/c")}
    for number, (topic, message) in enumerate(arrivals):
        append[topic](message, number)
        assert buffer.nbytes <= 10_000
    for topic in append:
        of_topic = [m for t, m in arrivals if t == topic]
        kept = buffer.snapshot(topic)
        assert kept.dropped + len(kept) == len(of_topic)
        assert list(kept) == of_topic[kept.dropped :]


def test_a_flood_on_one_topic_does_not_push_out_the_single_message_of_another() -> None:
    buffer = MessageBuffer(["/map", "/camera"], 200_000)
    buffer.appender("/map")(b"the map", 0)
    camera = buffer.appender("/camera")
    for number in range(1000):
        camera(bytes(5000), number)
    assert list(buffer.snapshot("/map")) == [b"the map"]
    assert 20 < len(buffer.snapshot("/camera")) < 40


def test_a_message_that_is_bigger_than_all_room_is_dropped_and_the_others_stay() -> None:
    kept = filled([b"one", bytes(100_000), b"three"], max_bytes=10_000).snapshot("/a")
    assert kept.dropped == 1 and list(kept) == [b"one", b"three"]


@patient
@given(st.lists(st.binary(min_size=12, max_size=60), min_size=1, max_size=100), st.integers(0, 4))
def test_columns_read_the_same_bytes_of_every_message(messages: list[bytes], offset: int) -> None:
    kept = filled(messages, keep=50).snapshot("/a")
    assert kept.columns(offset, 8).tolist() == [list(m[offset : offset + 8]) for m in messages[-50:]]


def test_columns_refuse_what_a_message_does_not_have() -> None:
    with pytest.raises(ValueError, match="3 bytes"):
        filled([b"abc"]).snapshot("/a").columns(0, 8)
    with pytest.raises(IndexError):
        filled([b"abc"]).snapshot("/a")[1]


def test_a_reader_sees_whole_messages_while_another_thread_appends() -> None:
    buffer = MessageBuffer(["/a"], 300_000)
    append = buffer.appender("/a")
    done = threading.Event()

    def write() -> None:
        for number in range(60_000):
            append(b"%08d" % number * (1 + number % 7), number)
        done.set()

    writer = threading.Thread(target=write)
    writer.start()
    looks = 0
    while not done.is_set() or looks == 0:
        kept = buffer.snapshot("/a")
        looks += 1
        numbers = kept.receive_ns
        assert np.all(np.diff(numbers) == 1)
        for index in range(0, len(kept), 97):
            assert kept[index] == b"%08d" % numbers[index] * (1 + int(numbers[index]) % 7)
    writer.join()
    assert len(buffer.snapshot("/a")) + buffer.snapshot("/a").dropped == 60_000


@pytest.mark.parametrize(("max_bytes", "keep"), [(100, None), (1 << 20, 0)])
def test_limits_that_hold_nothing_are_refused(max_bytes: int, keep: int | None) -> None:
    with pytest.raises(ValueError, match=r"max_bytes=100|keep=0"):
        MessageBuffer(["/a"], max_bytes, keep)
