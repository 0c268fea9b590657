"""Every kernel of the course's environment knows `%ros2` and `%progress`."""

c = get_config()  # type: ignore[name-defined] # noqa: F821
c.InteractiveShellApp.extensions.extend(["course_kit.ros2.magic", "course_kit.checking.notebook"])
