"""`ros2 service`: list, type and find, as of all that has a name; call, echo and info in modules of their own."""

from __future__ import annotations

from course_kit.cli.ros2.named import SERVICES
from course_kit.cli.ros2.service.call import CALL
from course_kit.cli.ros2.service.echo import ECHO
from course_kit.cli.ros2.service.info import INFO

add_arguments = SERVICES.hidden
VERBS = {**SERVICES.verbs(), "call": CALL, "echo": ECHO, "info": INFO}
