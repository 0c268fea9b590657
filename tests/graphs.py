"""Graphs as data for tests: a few nodes, a fleet, what cannot match, and graphs at random."""

from __future__ import annotations

import random
from collections.abc import Iterable

from course_kit.ros.graph.snapshot import Channel, Endpoint, GraphNode, Qos, Snapshot

RELIABLE, BEST_EFFORT, LATCHED = Qos(), Qos("best_effort"), Qos(durability="transient_local")
TWIST, SCAN, TEXT, POSE = (
    "geometry_msgs/msg/Twist",
    "sensor_msgs/msg/LaserScan",
    "std_msgs/msg/String",
    "a_msgs/msg/Pose",
)


def channel(
    name: str,
    type_name: str,
    sources: Iterable[str],
    sinks: Iterable[str],
    offered: Qos = RELIABLE,
    asked: Qos = RELIABLE,
    kind: str = "topic",
) -> Channel:
    """A channel whose ends agree on the type."""
    ends = tuple(Endpoint(n, type_name, offered) for n in sources), tuple(Endpoint(n, type_name, asked) for n in sinks)
    return Channel(kind, name, *ends)


def snapshot(channels: Iterable[Channel], extra: Iterable[str] = ()) -> Snapshot:
    """The channels with the nodes that they name, and some more."""
    there = tuple(sorted(channels))
    names = {end.node for one in there for end in one.ends} | set(extra)
    return Snapshot(tuple(GraphNode(name) for name in sorted(names)), there)


def turtle() -> Snapshot:
    """Five nodes with a cycle, a topic that nobody hears, and an action."""
    return snapshot(
        [
            channel("/chatter", TEXT, ["/talker"], ["/listener"]),
            channel("/turtle1/cmd_vel", TWIST, ["/follower"], ["/turtlesim"]),
            channel("/turtle1/pose", "turtlesim/msg/Pose", ["/turtlesim"], ["/follower", "/logger"]),
            channel("/turtle1/color_sensor", "turtlesim/msg/Color", ["/turtlesim"], []),
            channel("/turtle1/rotate", "turtlesim/action/RotateAbsolute", ["/follower"], ["/turtlesim"], kind="action"),
        ]
    )


def unmatched() -> Snapshot:
    """Ends that do not match by type, reliability and durability; a service, a lonely action, a name used twice."""
    made = snapshot(
        [
            channel("/chatter", TEXT, ["/talker"], ["/listener"]),
            Channel(
                "topic",
                "/numbers",
                (Endpoint("/counter", "std_msgs/msg/Int32"),),
                (Endpoint("/listener", TEXT), Endpoint("/adder", "std_msgs/msg/Int32")),
            ),
            Channel(
                "topic",
                "/scan",
                (Endpoint("/lidar", SCAN, BEST_EFFORT),),
                (Endpoint("/mapper", SCAN), Endpoint("/viewer", SCAN, BEST_EFFORT)),
            ),
            channel("/map", "nav_msgs/msg/OccupancyGrid", ["/mapper"], ["/viewer"], RELIABLE, LATCHED),
            channel("/cmd_vel", TWIST, ["/adder"], []),
            channel("/robot/cmd_vel", TWIST, [], ["/base"]),
            channel("/spin", "turtlesim/action/RotateAbsolute", ["/adder"], [], kind="action"),
            channel("/add", "example_interfaces/srv/AddTwoInts", ["/counter"], ["/adder"], kind="service"),
        ]
    )
    nodes = tuple(GraphNode(n.name, 2 if n.name == "/viewer" else 1) for n in made.nodes)
    return Snapshot(nodes, made.channels)


def fleet(robots: int = 6) -> Snapshot:
    """Robots with ten nodes each in namespaces of their own, and two nodes for all of them; some ends do not match."""
    channels = []
    planners = [f"/robot{n}/planner" for n in range(1, robots + 1)]
    for n in range(1, robots + 1):
        space = f"/robot{n}"
        for name, type_name, sources, sinks in (
            ("pose", "geometry_msgs/msg/Pose", "localisation", "planner"),
            ("odom", "nav_msgs/msg/Odometry", "base_driver", "localisation controller"),
            ("obstacles", "geometry_msgs/msg/PoseArray", "obstacle_detector", "planner"),
            ("plan", "nav_msgs/msg/Path", "planner", "controller"),
            ("cmd_vel", TWIST, "controller", "base_driver"),
            ("image_raw/compressed", "sensor_msgs/msg/CompressedImage", "image_compressor", ""),
        ):
            speakers, listeners = ([f"{space}/{node}" for node in side.split()] for side in (sources, sinks))
            channels.append(channel(f"{space}/{name}", type_name, speakers, listeners))
        asked = RELIABLE if n == 3 else BEST_EFFORT
        hears = [f"{space}/localisation", f"{space}/obstacle_detector"]
        channels += [
            channel(f"{space}/scan", SCAN, [f"{space}/lidar"], hears, BEST_EFFORT, asked),
            channel(f"{space}/image_raw", "sensor_msgs/msg/Image", [f"{space}/camera"], [f"{space}/image_compressor"]),
            channel(f"{space}/battery", "sensor_msgs/msg/BatteryState", [f"{space}/battery"], ["/fleet_manager"]),
        ]
    goal = "geometry_msgs/msg/PoseStamped"
    takers = (Endpoint(p, goal if "5" not in p else "geometry_msgs/msg/Pose") for p in planners)
    channels += [
        channel("/map", "nav_msgs/msg/OccupancyGrid", ["/map_server"], planners, LATCHED, LATCHED),
        Channel("topic", "/fleet/goal", (Endpoint("/fleet_manager", goal),), tuple(takers)),
    ]
    return snapshot(channels, [f"/robot{n}/health" for n in range(1, robots + 1)])


def at_random(seed: int, nodes: int = 60, topics: int = 60) -> Snapshot:
    """Any node may talk to any other, in four namespaces; types and QoS differ now and then."""
    rng = random.Random(seed)
    spaces = ("", "/left", "/right", "/left/arm")
    names = [f"{rng.choice(spaces)}/node_{n}" for n in range(nodes)]
    channels = []
    for n in range(topics):
        ends = [
            tuple(
                Endpoint(name, rng.choice([TEXT] * 9 + [TWIST]), rng.choice([RELIABLE, RELIABLE, BEST_EFFORT, LATCHED]))
                for name in rng.sample(names, rng.choice(counts))
            )
            for counts in ((1, 1, 2), (0, 1, 1, 3))
        ]
        channels.append(Channel("topic", f"{rng.choice(spaces)}/topic_{n}", *ends))
    return snapshot(channels, names)
