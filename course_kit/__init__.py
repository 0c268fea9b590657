"""What the notebooks of the course stand on: nodes in the background, processes, recordings, plots.

Importing this package starts nothing and is quick; each name below is loaded when it is first used.
"""

from __future__ import annotations

import importlib

TYPE_CHECKING = False  # type checkers take it for True; importing typing would cost every start of Python 5 ms
if TYPE_CHECKING:
    from typing import Any

# The public names of each module.
MODULES = {
    "background.log_levels": ("log_level", "set_log_level"),
    "background.running": ("run", "running", "stop", "nodes"),
    "background.waiting": ("wait_for",),
    "callbacks.callback_time_plots": ("plot_callback_times",),
    "callbacks.executor_plots": ("plot_executor",),
    "catching_up": ("catch_up",),
    "checking.notebook": ("check",),
    "checking.solution": ("solution",),
    "colcon.workspaces": ("Workspace",),
    "live.form": ("show_form",),
    "live.graph": ("show_graph",),
    "live.logs": ("watch_logs",),
    "live.rates": ("watch_rates",),
    "live.resources": ("watch_resources",),
    "live.robot": ("show_robot",),
    "live.values": ("watch_values",),
    "node_logs.log_directory": ("log_files",),
    "node_logs.rosout": ("logs", "log_rates"),
    "programs.processes": ("start",),
    "recordings.meters": ("rates", "measure_rates"),
    "recordings.plots": ("plot_pose", "plot_rates"),
    "recordings.recording": ("record",),
    "replays.replay_plots": ("plot_comparison",),
    "replays.replayed": ("compare",),
    "replays.replaying": ("replay",),
    "resources.processes_with_nodes": ("node_processes",),
    "resources.resource_plots": ("plot_resources",),
    "resources.resource_recording": ("record_resources",),
    "ros_graph.graph_plots": ("plot_graph",),
    "scene.scene_plots": ("plot_scene",),
    "series.value_plots": ("plot_values",),
    "series.value_series": ("values", "save_csv"),
    "tf_tools.frame_plots": ("plot_frames",),
}
EXPORTS = {name: module for module, names in MODULES.items() for name in names}
__all__ = sorted(EXPORTS)


def __getattr__(name: str) -> Any:
    if name not in EXPORTS:
        raise AttributeError(f"module 'course_kit' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"course_kit.{EXPORTS[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return [*globals(), *EXPORTS]
