"""Faults inside a node that runs and is connected: callbacks, timers, queues, clocks, logs."""

from __future__ import annotations

from course_kit.exercises.faults.fault import MAP_SERVER, PLANNER, SCANNER, Fault, Start, planner, restart

FAULTS = (
    Fault(
        id="slow_callback",
        cause="A callback takes too long: while it runs, the node's other callbacks wait.",
        symptom="The turtle drives in jerks and runs into walls.",
        evidence=(
            "A node's topic would come far too seldom, with little CPU: `%ros2 topic hz` beside the rate it "
            "should have."
        ),
        hints=(
            "The planner should send 10 commands a second. `%ros2 topic hz /turtle1/cmd_vel --duration 5`",
            "Its timer is set to 10 Hz: `%ros2 param get /planner rate`. What keeps the timer's callback waiting?",
            "One thread serves all callbacks of a node. `%ros2 param get /planner planning_time`: for each scan.",
        ),
        cure="%ros2 param set /planner planning_time 0.0",
        alike=("timer", "queue", "deadlock", "duplicate"),
        commands=("ros2 topic hz /turtle1/cmd_vel --duration 4", "ros2 param get /planner planning_time"),
        start=planner("-p", "planning_time:=1.0"),
        says="driving",
    ),
    Fault(
        id="deadlock",
        cause="A callback waits for an answer that only its own executor could deliver: client.call() in a callback.",
        symptom="The turtle stands still. All four nodes are listed, and the planner has gone silent.",
        evidence=(
            "A node would be listed and send nothing at all, not even answers about its parameters: "
            "`%ros2 param get /planner rate` gets none."
        ),
        hints=(
            "Does the planner send anything? `%ros2 topic hz /turtle1/cmd_vel --duration 3`",
            "Its node is there. Does it still answer? `%ros2 param get /planner rate`, which gives up after 10 s",
            "Everything in it waits. What does it do as its very first thing? It asks for the map, in a "
            "timer's callback.",
        ),
        alike=("no_spin", "no_server", "clock", "slow_callback"),
        commands=("ros2 node list", "ros2 topic hz /turtle1/cmd_vel --duration 3"),
        start=planner("-p", "synchronous:=true"),
        says="found /get_map",
    ),
    Fault(
        id="no_spin",
        cause="A node is never spun: it sends, but no callback of it runs, so no message and no answer reaches it.",
        symptom="The turtle stands still. The planner sends commands, and says that it gets no map, though it asks.",
        evidence=(
            "A node would send and receive nothing: its requests are served, its parameters do not answer "
            "(`%ros2 param get /planner rate`)."
        ),
        hints=(
            "`%ros2 topic echo /turtle1/cmd_vel --once`: commands come, and all are zero. What is it waiting for?",
            "The service works: `%ros2 service call /get_map nav_msgs/srv/GetMap`. So the answer is sent. "
            "Who takes it?",
            "An answer, a message, a parameter request: each is a callback. Who calls them? `%ros2 param get "
            "/planner rate`",
        ),
        alike=("deadlock", "no_server", "clock", "service_name"),
        commands=("ros2 topic echo /turtle1/cmd_vel --once", "ros2 service info /get_map"),
        start=planner("-p", "own_loop:=true"),
        says="no map",
    ),
    Fault(
        id="queue",
        cause="A queue is too short: messages that come while the subscriber is busy are lost.",
        symptom="The turtle drives, but the map has holes: half of the scans never get into it.",
        evidence=(
            "A subscriber would get fewer messages than are sent, in step with the pauses in which it works: "
            "compare `%ros2 topic hz /scan` with what `/map_scans` counts."
        ),
        hints=(
            "`rates('/scan', '/map_scans')` and `%ros2 topic echo /map_scans --duration 2`: 10 scans a second are "
            "sent. How many are counted?",
            "The map server works 0.4 s at a time (`%ros2 param get /map_server update_time`). Where do scans wait?",
            "`%ros2 param list /map_server`: its subscription's depth can be set when it starts. What is it?",
        ),
        alike=("slow_callback", "qos", "timer", "name"),
        commands=(
            "ros2 param get /map_server qos_overrides./scan.subscription.depth",
            "ros2 topic echo /map_scans --duration 2",
        ),
        start=Start(MAP_SERVER, ("-p", "qos_overrides./scan.subscription.depth:=1")),
        says="driving",
    ),
    Fault(
        id="timer",
        cause="A timer's period is far too short, so a node sends far too often.",
        symptom="The turtle drives, but the computer is loud and warm.",
        evidence=(
            "A topic would come at a multiple of its rate from one publisher: `%ros2 topic hz`, and `info` to count."
        ),
        hints=(
            "Which process computes? `psutil.Process(faults.process('planner').pid).cpu_percent(1.0)`, and the others.",
            "What does it do so often? `rates('/scan', '/turtle1/cmd_vel')`",
            "`%ros2 param get /planner rate`. How many commands a second does a turtle need?",
        ),
        alike=("logging", "duplicate", "slow_callback", "queue"),
        commands=("ros2 topic hz /turtle1/cmd_vel --duration 2", "ros2 topic info /turtle1/cmd_vel"),
        start=planner("-p", "rate:=400.0"),
        says="driving",
    ),
    Fault(
        id="logging",
        cause="A node logs far too much: it runs on a level that is meant for one who looks for an error.",
        symptom="The turtle drives, but log files grow by the minute and the last warning can no longer be found.",
        evidence="One node would fill `/rosout`: `%ros2 topic hz /rosout`, and `logs(level='DEBUG')` says who it is.",
        hints=(
            "Measure the log: `%ros2 topic hz /rosout --duration 3`, or `%ros2 topic bw /rosout --duration 3`",
            "`logs(level='DEBUG', last=5)`: who writes, and on which level?",
            "A level can be changed while a node runs: `%ros2 service type /planner/set_logger_levels`",
        ),
        cure=(
            "%ros2 service call /planner/set_logger_levels rcl_interfaces/srv/SetLoggerLevels "
            '"{levels: [{name: planner, level: 20}]}"'
        ),
        alike=("timer", "duplicate", "crash", "slow_callback"),
        commands=("ros2 topic hz /rosout --duration 2", "ros2 topic echo /rosout --once --field level"),
        start=planner("--log-level", "planner:=debug"),
        says="driving",
    ),
    Fault(
        id="clock",
        cause="A node runs on simulated time (use_sim_time), and nobody publishes /clock.",
        symptom="The turtle stands still. All four nodes are listed, and the planner sends nothing.",
        evidence=(
            "A node would answer all questions, and its timers would never fire: `%ros2 param get … use_sim_time`, "
            "and `/clock` would have a subscriber and no publisher."
        ),
        hints=(
            "The planner sends nothing, yet it answers: `%ros2 param get /planner rate`. So it is spun.",
            "A timer follows a clock. Which one? `%ros2 param get /planner use_sim_time`",
            "`%ros2 topic info /clock`: who publishes the time that it waits for?",
        ),
        cure="%ros2 param set /planner use_sim_time false",
        alike=("deadlock", "no_spin", "timer", "crash"),
        commands=("ros2 param get /planner use_sim_time", "ros2 topic info /clock"),
        start=planner("-p", "use_sim_time:=true"),
    ),
    Fault(
        id="crash",
        cause="A callback raised an exception, which ended its program.",
        symptom="The turtle stands still. The planner worked for a moment.",
        evidence=(
            "A program would have ended with a traceback: `faults.process('planner')` has its state and its lines."
        ),
        hints=(
            "Who is missing in `%ros2 node list`? `faults.process('planner').state`",
            "It left a reason: `print(faults.process('planner').output)`",
            "`min()` of nothing: it got a scan without beams. `%ros2 param get /scanner beams` was 36 once. "
            "Mend that first, then start the planner again.",
        ),
        cure=f"%ros2 param set /scanner beams 36\n{restart(PLANNER)}",
        alike=("dead", "conda", "no_spin", "not_sourced"),
        commands=("ros2 node list", "ros2 param get /scanner beams"),
        start=Start(SCANNER, ("-p", "beams:=0")),
        says="ValueError",
    ),
)
