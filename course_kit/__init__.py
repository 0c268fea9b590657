"""The package that the notebooks of the course stand on; students import everything from here.

Importing this package starts nothing and is quick; each name below is loaded when it is first used.
"""

from __future__ import annotations

import importlib

TYPE_CHECKING = False  # type checkers take it for True; importing typing would cost every start of Python 5 ms
if TYPE_CHECKING:
    from typing import Any

# The public names of each module.
MODULES = {
    "base.programs.processes": ("start",),
    "exercises.in_notebook.catching_up": ("catch_up",),
    "exercises.in_notebook.check": ("check",),
    "exercises.in_notebook.solution": ("solution",),
    "lab.background.log_levels": ("log_level", "set_log_level"),
    "lab.background.running": ("nodes", "run", "running", "stop"),
    "lab.background.waiting": ("wait_for",),
    "lab.callbacks.callback_time_plots": ("plot_callback_times",),
    "lab.callbacks.executor_plots": ("plot_executor",),
    "lab.callbacks.node_callbacks": ("execution_of",),
    "lab.calls.conversations": ("note_requests", "plot_conversation"),
    "lab.calls.goal_plots": ("plot_goal_states", "plot_goals"),
    "lab.calls.sequences": ("plot_calls",),
    "lab.calls.service_calls": ("calls_of",),
    "lab.node_logs.log_directory": ("log_files",),
    "lab.node_logs.rosout": ("log_rates", "logs"),
    "lab.recordings.rates": ("measure_rates", "rates"),
    "lab.recordings.plots": ("plot_pose", "plot_rates"),
    "lab.recordings.recording": ("record",),
    "lab.replays.replay_plots": ("plot_comparison",),
    "lab.replays.replayed": ("compare",),
    "lab.replays.replaying": ("replay",),
    "lab.resources.processes_with_nodes": ("node_processes",),
    "lab.resources.resource_plots": ("plot_resources",),
    "lab.resources.resource_recording": ("record_resources",),
    "lab.scene.scene_plots": ("plot_scene",),
    "lab.series.value_plots": ("plot_values",),
    "lab.series.value_series": ("save_csv", "values"),
    "lab.tf_tools.frame_plots": ("plot_frames",),
    "robots.navigation.grid": ("Grid",),
    "robots.navigation.grid_map": ("GridMap",),
    "robots.navigation.localizer": ("Localizer",),
    "robots.navigation.mapper": ("Mapper",),
    "robots.navigation.messages": (
        "LATCHED",
        "map_message",
        "map_of",
        "path_message",
        "place_of",
        "points_of",
        "pose_of",
        "stamped_pose",
        "transform_of",
    ),
    "robots.navigation.navigator": ("Navigator",),
    "robots.navigation.places": ("after", "between", "hits", "inverse", "moved", "wrapped"),
    "robots.navigation.planner": ("Planner",),
    "robots.navigation.planning": ("CostMap", "length", "plan", "PlanError", "spaced"),
    "robots.navigation.pursuit": ("Limits", "Pursuit"),
    "robots.robot.node": ("Robot",),
    "robots.robot.world": ("Pillar", "Wall", "World"),
    "robots.robot.worlds": ("world",),
    "robots.turtlesim.laser": ("Laser",),
    "robots.turtlesim.node": ("TurtleSim",),
    "robots.turtlesim.teleop": ("Teleop",),
    "ros.graph.action_plots": ("plot_action",),
    "ros.graph.plots": ("plot_graph",),
    "setup.colcon.chapter_packages": ("provide",),
    "setup.colcon.install_plots": ("plot_install",),
    "setup.colcon.workspaces": ("Workspace",),
    "setup.environment": ("check_environment",),
    "setup.environment.activation": ("DISTRO",),
    "views.live.form": ("show_form",),
    "views.live.graph": ("show_graph",),
    "views.live.logs": ("watch_logs",),
    "views.live.rates": ("watch_rates",),
    "views.live.resources": ("watch_resources",),
    "views.live.robot": ("show_robot",),
    "views.live.turtle": ("drive",),
    "views.live.values": ("watch_values",),
}
# The modules that are public as a whole, by their names here.
WHOLE = {"bags": "lab.bags", "faults": "exercises.faults", "grid": "robots.navigation.grid"}
EXPORTS = {name: module for module, names in MODULES.items() for name in names} | WHOLE
__all__ = sorted(EXPORTS)


def __getattr__(name: str) -> Any:
    if name not in EXPORTS:
        raise AttributeError(f"module 'course_kit' has no attribute {name!r}")
    module = importlib.import_module(f"course_kit.{EXPORTS[name]}")
    value = module if name in WHOLE else getattr(module, name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return [*globals(), *EXPORTS]
