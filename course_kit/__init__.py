"""What the notebooks of the course stand on: nodes in the background, processes, recordings, plots.

Importing this package starts nothing and is quick; each name below is loaded when it is first used.
"""

from __future__ import annotations

import importlib

TYPE_CHECKING = False  # type checkers take it for True; importing typing would cost every start of Python 5 ms
if TYPE_CHECKING:
    from typing import Any

# Where each public name comes from.
EXPORTS = {
    "run": "background.running",
    "running": "background.running",
    "stop": "background.running",
    "nodes": "background.running",
    "start": "programs.processes",
    "Workspace": "colcon.workspaces",
    "wait_for": "background.waiting",
    "logs": "node_logs.rosout",
    "record": "recordings.recording",
    "rates": "recordings.meters",
    "measure_rates": "recordings.meters",
    "plot_pose": "recordings.plots",
    "plot_rates": "recordings.plots",
    "plot_graph": "ros_graph.graph_plots",
    "show_graph": "live.graph",
    "watch_rates": "live.rates",
    "log_rates": "node_logs.rosout",
    "record_resources": "resources.resource_recording",
    "plot_resources": "resources.resource_plots",
    "watch_resources": "live.resources",
    "node_processes": "resources.processes_with_nodes",
    "log_level": "background.log_levels",
    "set_log_level": "background.log_levels",
    "watch_logs": "live.logs",
    "log_files": "node_logs.log_directory",
    "values": "series.value_series",
    "save_csv": "series.value_series",
    "plot_values": "series.value_plots",
    "watch_values": "live.values",
    "plot_scene": "scene.scene_plots",
    "replay": "replays.replaying",
    "compare": "replays.replayed",
    "plot_comparison": "replays.replay_plots",
    "check": "checking.notebook",
}
__all__ = sorted(EXPORTS)


def __getattr__(name: str) -> Any:
    if name not in EXPORTS:
        raise AttributeError(f"module 'course_kit' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"course_kit.{EXPORTS[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return [*globals(), *EXPORTS]
