"""Registers how objects of a type are transformed and converted, as tf2_geometry_msgs and its like need it."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from typing import Any, ClassVar

from std_msgs.msg import Header

Convert = Callable[[Any], Any]


class TypeException(Exception):  # noqa: N818 - tf2_ros's name
    """A type that nobody has registered."""

    def __init__(self, errstr: str) -> None:
        super().__init__(errstr)
        self.errstr = errstr


class NotImplementedException(Exception):  # noqa: N818
    """A method of a BufferInterface that its subclass lacks."""

    def __init__(self) -> None:
        self.errstr = "CanTransform or LookupTransform not implemented"
        super().__init__(self.errstr)


def _registered(known: dict[Any, Any], key: Any) -> Any:
    if key not in known:
        raise TypeException(f"Type {key} is not loaded or supported")
    return known[key]


class TransformRegistration:
    """Type -> do_transform(object, TransformStamped), one table for the process."""

    _transforms: ClassVar[dict[type, Callable[[Any, Any], Any]]] = {}

    def add(self, key: type, callback: Callable[[Any, Any], Any]) -> None:
        """Register a type."""
        self._transforms[key] = callback

    def get(self, key: type) -> Callable[[Any, Any], Any]:
        """What transforms objects of a type. TypeException if nobody has registered it."""
        return _registered(self._transforms, key)  # type: ignore[no-any-return]


class ConvertRegistration:
    """How types become messages, become of messages, and become others; one table each for the process."""

    _to_messages: ClassVar[dict[type, Convert]] = {}
    _from_messages: ClassVar[dict[type, Convert]] = {}
    _directly: ClassVar[dict[tuple[type, type], Convert]] = {}

    def add_to_msg(self, key: type, callback: Convert) -> None:
        """Register what makes a message of a type."""
        self._to_messages[key] = callback

    def add_from_msg(self, key: type, callback: Convert) -> None:
        """Register what makes a type of a message."""
        self._from_messages[key] = callback

    def add_convert(self, key: tuple[type, type], callback: Convert) -> None:
        """Register what makes the second type of the first."""
        self._directly[key] = callback

    def get_to_msg(self, key: type) -> Convert:
        """What makes a message of a type. TypeException if nobody has registered it; so of the others."""
        return _registered(self._to_messages, key)  # type: ignore[no-any-return]

    def get_from_msg(self, key: type) -> Convert:
        """What makes a type of a message."""
        return _registered(self._from_messages, key)  # type: ignore[no-any-return]

    def get_convert(self, key: tuple[type, type]) -> Convert:
        """What makes the second type of the first."""
        return _registered(self._directly, key)  # type: ignore[no-any-return]


def convert(a: Any, b_type: type) -> Any:
    """An object as another type: directly if somebody has registered that, else by way of a message."""
    registered = ConvertRegistration()
    try:
        return registered.get_convert((type(a), b_type))(a)
    except TypeException:
        if type(a) is b_type:
            return deepcopy(a)
    return registered.get_from_msg(b_type)(registered.get_to_msg(type(a))(a))


def Stamped(obj: Any, stamp: Any, frame_id: str) -> Any:  # noqa: N802 - as tf2_ros spells it
    """Give an object a header, and return it."""
    obj.header = Header(frame_id=frame_id, stamp=stamp)
    return obj
