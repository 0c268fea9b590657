"""Why a transform cannot be had. The names, and `tf2` as the module that a traceback shows, are those of ROS's tf2."""

from __future__ import annotations


class TransformException(Exception):  # noqa: N818 - tf2's name
    """Any of the reasons below."""


class LookupException(TransformException):
    """There is no such frame, or the frames are in a loop."""


class ConnectivityException(TransformException):
    """The frames are both known, but nothing connects them."""


class ExtrapolationException(TransformException):
    """The frames are connected, but not at that moment."""


class InvalidArgumentException(TransformException):
    """What cannot be the name of a frame."""


class TimeoutException(TransformException):
    """It did not come in time."""


for _each in (TransformException, *TransformException.__subclasses__()):
    _each.__module__ = "tf2"
