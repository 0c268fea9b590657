"""Leaves imports of rclpy out of a command that does not use them: a third of its time.

Without these `ros2` does what it does with them. Pure: imports no ROS.
"""

from __future__ import annotations

import contextlib
import importlib.util
import sys
import threading
from collections.abc import Iterator
from types import ModuleType

# rosidl_generator_py, of which messages need one function, goes without it where its templates are not installed.
GENERATOR = "rosidl_generator_py.generate_py_impl"
YAML = "yaml"


_loading = threading.RLock()  # other threads wait, the one that loads finds what there is so far


class _Later(ModuleType):
    """A module that is loaded when it is asked for something."""

    def __getattr__(self, name: str) -> object:
        if name.startswith("__"):  # the import system asks for such of a module, whatever it is
            raise AttributeError(name)
        with _loading:
            if (spec := self.__dict__.pop("loaded_from", None)) is not None:
                spec.loader.exec_module(self)
                self.__class__ = ModuleType  # type: ignore[assignment]
            if name in self.__dict__:
                return self.__dict__[name]
        raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")


def import_less() -> None:
    """Have this process, which generates no messages, load no generator of them, and YAML only if it is used.

    To be called before ROS is imported, by a process in which nothing else runs.
    """
    sys.modules.setdefault(GENERATOR, None)  # type: ignore[arg-type]  # so Python says: importing it fails
    spec = importlib.util.find_spec(YAML)
    if spec is not None and YAML not in sys.modules:
        later = importlib.util.module_from_spec(spec)
        later.__class__, later.__dict__["loaded_from"] = _Later, spec
        sys.modules[YAML] = later


class _Numpy(ModuleType):
    """Stands for numpy where it is imported, and loads it when it is asked for something."""

    def __getattr__(self, name: str) -> object:
        _take_away(self)
        return getattr(importlib.import_module("numpy"), name)


def _take_away(stand_in: ModuleType) -> None:
    if sys.modules.get("numpy") is stand_in:
        del sys.modules["numpy"]


@contextlib.contextmanager
def arrays_later() -> Iterator[None]:
    """Have the packages of messages that the block imports load numpy when an array is made of theirs.

    They all import it for the few that have arrays of a fixed length. Every service has such a message: its log of
    calls, which is kept if one asks for it.
    """
    stand_in = _Numpy("numpy")
    try:
        if sys.modules.setdefault("numpy", stand_in) is stand_in:
            with contextlib.suppress(ImportError):
                importlib.import_module("service_msgs.msg")
        yield
    finally:
        _take_away(stand_in)
