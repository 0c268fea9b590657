"""Faults by which nodes that run do not find each other: names, types, QoS, domains."""

from __future__ import annotations

from course_kit.exercises.faults.fault import MAP_SERVER, PLANNER, SCANNER, Fault, Start, planner

STANDS = "The turtle stands still. All four programs run."

FAULTS = (
    Fault(
        id="name",
        cause="A node listens to a topic that nobody publishes: the names at the two ends differ.",
        symptom=f"{STANDS} The planner says that it gets no scan.",
        evidence=(
            "The topic's subscriber would stand alone under a name of its own: `%ros2 topic list -v` counts both ends."
        ),
        hints=(
            "The planner logs what it lacks. Is that sent? `%ros2 topic hz /scan --duration 3`",
            "Who is at the other end? `%ros2 topic info -v /scan` names publishers and subscribers.",
            "What does the planner listen to, then? `%ros2 node info /planner`",
        ),
        alike=("qos", "type", "domain", "no_spin"),
        commands=("ros2 node info /planner", "ros2 topic info /laser"),
        start=planner("-p", "scan_topic:=laser"),
        says="no scan",
    ),
    Fault(
        id="type",
        cause="The publisher and the subscriber of a topic have different message types.",
        symptom=f"{STANDS} The planner says that it drives.",
        evidence=(
            "One topic would have two types: `%ros2 topic list -t` shows both, `%ros2 topic info -v` says "
            "whose they are."
        ),
        hints=(
            "The planner thinks that it drives. Follow its commands: `%ros2 topic info -v /turtle1/cmd_vel`",
            "A publisher and a subscription are there, under one name. What else must agree?",
            "Read the types: `%ros2 topic type /turtle1/cmd_vel`. Which one does a turtle take?",
        ),
        alike=("remapping", "qos", "no_spin", "timer"),
        commands=("ros2 topic type /turtle1/cmd_vel", "ros2 topic info -v /turtle1/cmd_vel"),
        start=planner("-p", "stamped_cmd_vel:=true"),
        says="driving",
    ),
    Fault(
        id="qos",
        cause="A subscription asks for more than its publisher offers: the QoS of the two does not match.",
        symptom=f"{STANDS} The planner says that it gets no scan, and `ros2 topic echo /scan` shows scans.",
        evidence="Both ends would have the same name and type, and other policies: `%ros2 topic info -v` shows them.",
        hints=(
            "Name and type of `/scan` agree at both ends: `%ros2 topic info /scan`. What is the third thing?",
            "`%ros2 topic info -v /scan` shows the QoS of each end. Compare the lines called Reliability.",
            "RELIABLE cannot be had from a publisher that offers BEST_EFFORT. `logs(level='WARN')` says so too.",
        ),
        alike=("name", "type", "domain", "queue"),
        commands=("ros2 topic info -v /scan", "ros2 param get /planner qos_overrides./scan.subscription.reliability"),
        start=planner("-p", "qos_overrides./scan.subscription.reliability:=reliable"),
        says="no scan",
    ),
    Fault(
        id="first_message",
        cause="A message was sent once, before its subscriber was there, and is not kept for those who come later.",
        symptom=f"{STANDS} The planner says that it has no speed limit.",
        evidence=(
            "Both ends of a topic would match, and nothing would come any more, because it was sent before: "
            "`%ros2 topic info -v` shows a subscription with Durability VOLATILE."
        ),
        hints=(
            "Was the limit sent? `%ros2 topic echo /speed_limit --once --qos-durability transient_local "
            "--qos-reliability reliable`",
            "So it was, and once only. When did the planner come, before or after? Who keeps it meanwhile?",
            "The publisher keeps its last message for latecomers that ask for it. Does the planner ask? "
            "`%ros2 topic info -v /speed_limit`: Durability.",
        ),
        alike=("qos", "name", "type", "no_spin"),
        commands=("ros2 topic info -v /speed_limit",),
        start=planner("-p", "qos_overrides./speed_limit.subscription.durability:=volatile"),
        says="no speed limit",
    ),
    Fault(
        id="domain",
        cause="A program runs in another ROS domain than the others.",
        symptom=f"{STANDS} Only three of the nodes are listed.",
        evidence=(
            "A program would run and be listed nowhere here; its terminal would say another number: "
            "`faults.terminal('scanner', 'printenv ROS_DOMAIN_ID')`."
        ),
        hints=(
            "Which node is missing in `%ros2 node list`? Its program runs: `faults.process('scanner')`",
            "The program is fine, and no one hears it. What separates programs on one machine from each other?",
            "Compare `faults.terminal('scanner', 'printenv ROS_DOMAIN_ID')` with `%env ROS_DOMAIN_ID`.",
        ),
        alike=("discovery", "dead", "not_sourced", "namespace"),
        commands=("ros2 node list", "ros2 topic info /scan"),
        start=Start(SCANNER, terminal="other domain"),
        says="no scan",
    ),
    Fault(
        id="discovery",
        cause="A program runs with discovery switched off (ROS_AUTOMATIC_DISCOVERY_RANGE=OFF).",
        symptom=f"{STANDS} Only three of the nodes are listed, and the planner says that it gets no map.",
        evidence=(
            "A program would run in the right domain and be listed nowhere; its terminal would say: "
            "`faults.terminal('map_server', 'printenv ROS_AUTOMATIC_DISCOVERY_RANGE')`."
        ),
        hints=(
            "Which node is missing in `%ros2 node list`? Does its program run? `faults.process('map_server')`",
            "Its domain is right: `faults.terminal('map_server', 'printenv ROS_DOMAIN_ID')`. What else hides a node?",
            "`faults.terminal('map_server', 'printenv ROS_AUTOMATIC_DISCOVERY_RANGE')`, and compare it with yours.",
        ),
        alike=("domain", "no_server", "conda", "service_name"),
        commands=("ros2 node list", "ros2 service type /get_map"),
        start=Start(MAP_SERVER, terminal="no discovery"),
        says="no map",
    ),
    Fault(
        id="namespace",
        cause="A node runs in a namespace, so all its names are other ones than the rest of the robot uses.",
        symptom=f"{STANDS} The planner says that it gets no map.",
        evidence="A node's own name would begin with another word: `%ros2 node list` shows /robot1/… for such a node.",
        hints=(
            "The planner calls `/get_map`. Does anybody serve it? `%ros2 service info /get_map`",
            "Read `%ros2 node list` letter by letter.",
            "The map server is `/robot1/map_server`: its service, and the scan it listens to, begin with /robot1 too.",
        ),
        alike=("service_name", "no_server", "remapping", "domain"),
        commands=("ros2 node list", "ros2 service list"),
        start=Start(MAP_SERVER, ("-r", "__ns:=/robot1")),
        says="no map",
    ),
    Fault(
        id="remapping",
        cause="A remapping rule names a topic that the program does not have, so the rule does nothing.",
        symptom=f"{STANDS} The planner says that it drives.",
        evidence=(
            "A topic would still have the name that stands in the program's code, such as /cmd_vel, with one end only: "
            "`%ros2 topic list -v`."
        ),
        hints=(
            "The planner says that it sends commands. Does the turtle's topic have a publisher? "
            "`%ros2 topic info /turtle1/cmd_vel`",
            "Where do they go? `%ros2 node info /planner` lists what it publishes.",
            "The rule should turn `cmd_vel` into `turtle1/cmd_vel`. How was it written? "
            "`faults.process('planner').command`",
        ),
        alike=("type", "namespace", "qos", "duplicate"),
        commands=("ros2 topic info /turtle1/cmd_vel", "ros2 node info /planner"),
        start=Start(PLANNER, ("-r", "cmd_vl:=turtle1/cmd_vel")),
        says="driving",
    ),
    Fault(
        id="service_name",
        cause="The server offers its service under another name than the one the client calls.",
        symptom=f"{STANDS} All four nodes are listed, and the planner says that it gets no map.",
        evidence="The server's node would be there, with a service of nearly that name: `%ros2 service list -t`.",
        hints=(
            "The planner calls `/get_map`. `%ros2 service info /get_map` counts who calls it and who serves it.",
            "The map server runs. What does it serve? `%ros2 node info /map_server`",
            "Look for the type: `%ros2 service find nav_msgs/srv/GetMap`",
        ),
        alike=("no_server", "namespace", "deadlock", "type"),
        commands=("ros2 service info /get_map", "ros2 service find nav_msgs/srv/GetMap"),
        start=Start(MAP_SERVER, ("-r", "get_map:=static_map")),
        says="no map",
    ),
)
