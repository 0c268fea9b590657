"""Faults of programs: not started, started twice, started in the wrong terminal, killed."""

from __future__ import annotations

from course_kit.exercises.faults.fault import MAP_SERVER, SCANNER, Fault, Start, planner

FAULTS = (
    Fault(
        id="no_server",
        cause="The server of a service was not started.",
        symptom="The turtle stands still. The planner says that it gets no map.",
        evidence=(
            "Neither the service nor its node would exist, nor a program for it: `%ros2 service list`, "
            "`%ros2 node list`."
        ),
        hints=(
            "The planner calls `/get_map`. `%ros2 service info /get_map` counts who calls it and who serves it.",
            "Who should serve it? Compare `%ros2 node list` with `faults.manual()`.",
            "The node is not there: does its program run? `faults.process('map_server')`",
        ),
        alike=("service_name", "namespace", "dead", "deadlock"),
        commands=("ros2 service info /get_map", "ros2 node list"),
        missing=MAP_SERVER,
        says="no map",
    ),
    Fault(
        id="duplicate",
        cause="Two nodes have the same name: an older one was left running.",
        symptom="The turtle trembles, as if two were driving it.",
        evidence=(
            "A name would be listed twice, and its topic would have two publishers: `%ros2 node list`, "
            "`%ros2 topic info`."
        ),
        hints=(
            "How many commands come a second? `%ros2 topic hz /turtle1/cmd_vel --duration 3`",
            "Who sends them? `%ros2 topic info -v /turtle1/cmd_vel`, and read what `%ros2 node list` warns of.",
            "One of them has been forgotten in some terminal. Find its process: `!ps -eo pid,lstart,args | grep "
            "patrol/planner`, or psutil, and end the older one.",
        ),
        cure=(
            "import psutil\n"
            "children = psutil.Process().children(recursive=True)\n"
            'planners = [one for one in children if "patrol/planner" in " ".join(one.cmdline())]\n'
            "min(planners, key=psutil.Process.create_time).terminate()"
        ),
        alike=("timer", "slow_callback", "remapping", "logging"),
        commands=("ros2 node list", "ros2 topic info /turtle1/cmd_vel"),
        extra=(planner("-p", "speed:=-0.5"),),
        says="driving",
    ),
    Fault(
        id="not_sourced",
        cause="A program was to be started in a terminal in which the workspace had not been sourced.",
        symptom="The turtle stands still. Only three of the nodes are listed.",
        evidence="`ros2 run` would not know the package: `faults.process('planner').output` would say so.",
        hints=(
            "Which of the four is missing? What did its program say? `print(faults.process('planner').output)`",
            "Where does ros2 look for packages? `faults.terminal('planner', 'printenv AMENT_PREFIX_PATH')`",
            "Compare with a good terminal: `%ros2 pkg prefix patrol`, and `%env AMENT_PREFIX_PATH`.",
        ),
        alike=("conda", "domain", "crash", "discovery"),
        commands=("ros2 node list", "ros2 topic info /turtle1/cmd_vel"),
        start=planner(terminal="not sourced"),
    ),
    Fault(
        id="conda",
        cause="A program was started by conda's Python, which stands first on PATH and knows nothing of ROS 2.",
        symptom="The turtle stands still. Only three of the nodes are listed.",
        evidence=(
            "Python would miss a module of ROS 2 in one terminal only: `faults.terminal('scanner', 'which python3')`."
        ),
        hints=(
            "Which of the four is missing? What did its program say? `print(faults.process('scanner').output)`",
            "`rclpy` is installed, this notebook uses it. Which Python did not find it? "
            "`faults.terminal('scanner', 'which python3')`",
            "Who put that Python first? `faults.terminal('scanner', 'printenv PATH')`. `conda deactivate` is the cure.",
        ),
        alike=("not_sourced", "domain", "dead", "crash"),
        commands=("ros2 node list", "ros2 topic info /scan"),
        start=Start(SCANNER, terminal="conda"),
        says="no scan",
    ),
    Fault(
        id="dead",
        cause="A program was killed; its node is still listed until its lease ends, 20 s with DDS as it comes.",
        symptom=(
            "The turtle stands still. All four nodes are listed. (Look at once: one of them may be gone in 20 seconds. "
            "Start the fault again to have them back.)"
        ),
        evidence="A node would be listed whose program has ended: `faults.process('scanner')` says by which signal.",
        hints=(
            "`/scan` has a publisher, says `%ros2 topic info /scan`. Does a scan come? `%ros2 topic hz /scan "
            "--duration 3`",
            "The list of nodes is what this notebook remembers. A newcomer knows another one: `!ros2 node list`. Why?",
            "Ask the system about the program: `faults.process('scanner').state`. Whoever is killed says no goodbye.",
        ),
        alike=("deadlock", "qos", "domain", "crash"),
        commands=("ros2 node list", "ros2 topic info /scan"),
        start=Start(SCANNER, terminal="long lease"),
        killed=SCANNER,
    ),
)
