"""`ros2 service`: list, type and find, as of all that has a name; call, echo and info in modules of their own."""

from __future__ import annotations

from course_kit.cli.ros2.named import SERVICES
from course_kit.cli.ros2.verbs import Verb

add_arguments = SERVICES.hidden
VERBS: dict[str, Verb | str] = {
    **SERVICES.verbs(),
    "call": "service.call:CALL",
    "echo": "service.echo:ECHO",
    "info": "service.info:INFO",
}
