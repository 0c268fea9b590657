"""Buffer of tf2_ros: a BufferCore that one can wait for.

A wait blocks the thread that it is called in, as in ROS: called in a callback of a single-threaded executor that also
has the listener's callbacks, it waits in vain, for the transforms come only after it. A MultiThreadedExecutor, a
listener on a node of its own with spin_thread=True, or the async methods do not have that.
"""

from __future__ import annotations

import contextlib
import threading
import time as clocks
import weakref
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from geometry_msgs.msg import TransformStamped
from rclpy.clock import Clock, JumpHandle, JumpThreshold
from rclpy.duration import Duration
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node
from rclpy.task import Future
from tf2_msgs.srv import FrameGraph

from course_kit.robots.tf.buffer_interface import BufferInterface
from course_kit.robots.tf.conversions import SECOND, nanoseconds
from course_kit.robots.tf.core import BufferCore

Answer = tuple[bool, str]


class Waiting(NamedTuple):
    """A future that gets a transform when there is one."""

    future: Future
    is_there: Callable[[], Answer]
    look_up: Callable[[], TransformStamped]

    def settle(self) -> None:
        """Hand over the transform, unless nobody waits any more."""
        if not (self.future.done() or self.future.cancelled()):
            try:
                self.future.set_result(self.look_up())
            except Exception as error:
                self.future.set_exception(error)


class Buffer(BufferCore, BufferInterface):
    """Frames, and where they have been in each other, to be filled by a TransformListener.

    With a `node` it offers the service tf2_frames, and forgets where frames have been when the node's clock jumps back.
    """

    def __init__(self, cache_time: Duration | None = None, node: Node | None = None) -> None:
        BufferCore.__init__(self, cache_time)
        BufferInterface.__init__(self)
        self._new_data = threading.Condition()
        self._waiting: list[Waiting] = []
        self.clock = Clock() if node is None else node.get_clock()
        if node is not None:
            self.logger = node.get_logger()
            self.srv = node.create_service(FrameGraph, "tf2_frames", self._frames)
            back = JumpThreshold(min_forward=None, min_backward=Duration(seconds=-1), on_clock_change=True)
            jumped = partial(_clear_after_jump, weakref.ref(self))
            self.jump_handle = self.clock.create_jump_callback(back, post_callback=jumped)
            # The clock calls a handle that has become garbage, too, or what lies in its place then.
            weakref.finalize(self, _end, self.jump_handle).atexit = False

    def _frames(self, _: Any, response: Any) -> Any:
        response.frame_yaml = self.all_frames_as_yaml()
        return response

    def set_transform(self, transform: TransformStamped, authority: str) -> None:
        """Take in where a frame is in its parent at a moment; who waits for it goes on."""
        super().set_transform(transform, authority)
        self._tell()

    def set_transform_static(self, transform: TransformStamped, authority: str) -> None:
        """Take in where a frame is in its parent at all times; who waits for it goes on."""
        super().set_transform_static(transform, authority)
        self._tell()

    def _tell(self) -> None:
        with self._new_data:
            self._new_data.notify_all()
            ready = [w for w in self._waiting if w.future.done() or w.future.cancelled() or w.is_there()[0]]
            self._waiting = [waiting for waiting in self._waiting if waiting not in ready]
        for waiting in ready:
            waiting.settle()

    def lookup_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Duration = Duration(),  # noqa: B008 - as tf2_ros has it
    ) -> TransformStamped:
        """Where the source frame is in the target frame at a time, waiting for up to `timeout`.

        A zero time is the latest for which there is a transform. TransformException if there is none.
        """
        self.can_transform(target_frame, source_frame, time, timeout)
        return self.lookup_transform_core(target_frame, source_frame, time)

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Duration = Duration(),  # noqa: B008
    ) -> TransformStamped:
        """Where the source frame was at source_time in the target frame of target_time; `fixed_frame` stands still."""
        self.can_transform_full(target_frame, target_time, source_frame, source_time, fixed_frame, timeout)
        return self.lookup_transform_full_core(target_frame, target_time, source_frame, source_time, fixed_frame)

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Duration = Duration(),  # noqa: B008
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return True if there is a transform, waiting for up to `timeout`; with return_debug_tuple also why not."""
        answer = self._wait(partial(self.can_transform_core, target_frame, source_frame, time), timeout)
        return answer if return_debug_tuple else answer[0]

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Duration = Duration(),  # noqa: B008
        return_debug_tuple: bool = False,
    ) -> Any:
        """The same between two moments."""
        times = (target_frame, target_time, source_frame, source_time, fixed_frame)
        answer = self._wait(partial(self.can_transform_full_core, *times), timeout)
        return answer if return_debug_tuple else answer[0]

    def _wait(self, is_there: Callable[[], Answer], timeout: Any) -> Answer:
        # By the wall's clock, also where the node's time is simulated: as in ROS.
        deadline = clocks.monotonic() + nanoseconds(timeout, "timeout") / SECOND
        with self._new_data:
            while not (answer := is_there())[0] and (left := deadline - clocks.monotonic()) > 0:
                self._new_data.wait(left)
        return answer

    async def lookup_transform_async(self, target_frame: str, source_frame: str, time: Any) -> TransformStamped:
        """lookup_transform() for `await` in a callback: it waits as long as it takes, and blocks nothing."""
        await self.wait_for_transform_async(target_frame, source_frame, time)
        return self.lookup_transform_core(target_frame, source_frame, time)

    async def lookup_transform_full_async(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> TransformStamped:
        """The same between two moments."""
        times = (target_frame, target_time, source_frame, source_time, fixed_frame)
        await self.wait_for_transform_full_async(*times)
        return self.lookup_transform_full_core(*times)

    def wait_for_transform_async(self, target_frame: str, source_frame: str, time: Any) -> Future:
        """A future of a transform: done when there is one."""
        wanted = (target_frame, source_frame, time)
        return self._future(partial(self.can_transform_core, *wanted), partial(self.lookup_transform_core, *wanted))

    def wait_for_transform_full_async(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> Future:
        """The same between two moments."""
        wanted = (target_frame, target_time, source_frame, source_time, fixed_frame)
        return self._future(
            partial(self.can_transform_full_core, *wanted), partial(self.lookup_transform_full_core, *wanted)
        )

    def _future(self, is_there: Callable[[], Answer], look_up: Callable[[], TransformStamped]) -> Future:
        waiting = Waiting(Future(), is_there, look_up)
        with self._new_data:
            ready = is_there()[0]
            if not ready:
                self._waiting.append(waiting)
        if ready:
            waiting.settle()
        return waiting.future


def _end(handle: JumpHandle) -> None:
    with contextlib.suppress(InvalidHandle):  # of a node that was destroyed before
        handle.unregister()


def _clear_after_jump(reference: weakref.ref[Buffer], _: Any) -> None:
    buffer = reference()
    if buffer is not None:
        buffer.logger.warning("Detected jump back in time. Clearing tf buffer.")
        buffer.clear()
