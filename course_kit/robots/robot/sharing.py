"""Robots of one process that ask for the same world drive in the same simulation. No ROS."""

from __future__ import annotations

import threading
from collections.abc import Hashable

from course_kit.robots.robot.simulation import Rider, Simulation
from course_kit.robots.robot.vehicle import Vehicle
from course_kit.robots.robot.world import Place, World

_lock = threading.Lock()
_running: dict[tuple[Hashable, World], Simulation] = {}


def join(
    owner: Hashable,
    world: World,
    factor: float | None,
    rider: Rider,
    start: Place | None,
    timeout: float,
    patience: float = 0.0,
) -> tuple[Simulation, Vehicle]:
    """Put a robot into the simulation of this world that `owner` has, or into a new one; without a factor at 1.

    ValueError for a start that is not free, and for another factor than that of a simulation that runs.
    """
    with _lock:
        simulation = _running.get((owner, world)) or Simulation(world, 1.0 if factor is None else factor)
        if factor is not None and factor != simulation.factor:
            raise ValueError(
                f"the world {world.name!r} runs at factor {simulation.factor:g} already, for another robot: "
                f"give this one the same factor, or stop the other first"
            )
        vehicle = simulation.join(rider, start, timeout, patience)
        _running[owner, world] = simulation
        return simulation, vehicle


def leave(simulation: Simulation, vehicle: Vehicle) -> None:
    """Take a robot out again; the last one ends the simulation."""
    with _lock:
        simulation.leave(vehicle.number)
        if simulation.is_empty:
            for key in [key for key, one in _running.items() if one is simulation]:
                del _running[key]
