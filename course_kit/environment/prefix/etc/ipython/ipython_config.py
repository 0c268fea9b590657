"""Every kernel of the course's environment knows `%ros2`."""

c = get_config()  # type: ignore[name-defined] # noqa: F821
c.InteractiveShellApp.extensions.append("course_kit.ros2.magic")
