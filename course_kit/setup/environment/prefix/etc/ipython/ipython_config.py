"""The extensions of every kernel of the course's environment, `%ros2` and `%progress` among them."""

c = get_config()  # type: ignore[name-defined] # noqa: F821
c.InteractiveShellApp.extensions.extend(
    ["course_kit.views.live.kernel_start", "course_kit.cli.ros2.magic", "course_kit.exercises.in_notebook.check"]
)
