"""Answers to setup-1: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

REPORT = worked("setup-1")
RANGE = 'os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"]'
# Where the nodes are says the middleware, not a variable that is set later; what follows the check restores it.
ELSEWHERE = """
stop()
before, cells = os.environ["ROS_DOMAIN_ID"], []
os.environ["ROS_DOMAIN_ID"] = str((int(before) + 1) % 100)
domain = int(os.environ["ROS_DOMAIN_ID"])
discovery_range = os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"]

def restore(result):
    cells.append(result)
    if len(cells) == 2:
        os.environ["ROS_DOMAIN_ID"] = before
        get_ipython().events.unregister("post_run_cell", restore)

get_ipython().events.register("post_run_cell", restore)
"""
REPORTS = {
    "numpy": """
domain = np.array([os.environ["ROS_DOMAIN_ID"]], dtype=np.uint8)[0]
discovery_range = np.array(["LOCALHOST"])[0]
""",
    "asks_ros": """
domain = rclpy.get_default_context().get_domain_id()
discovery_range = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
""",
    "asks_the_report": """
details = {check.name.lower(): check.detail for check in report.checks}
domain = int(next(details[name] for name in details if "domain" in name))
discovery_range = next(details[name] for name in details if "range" in name or "discovery" in name)
""",
}

ANSWERS = Answers(
    "setup-1",
    1,
    REPORT,
    [
        Wrong(
            "text",
            changed(REPORT, ('int(os.environ["ROS_DOMAIN_ID"])', 'os.environ["ROS_DOMAIN_ID"]')),
            0,
            "a number, without quotes",
        ),
        Wrong("zero", changed(REPORT, ('int(os.environ["ROS_DOMAIN_ID"])', "0")), 0, "You gave 0."),
        Wrong("subnet", changed(REPORT, (RANGE, '"SUBNET"')), 0, "You gave 'SUBNET'"),
        Wrong("half", changed(REPORT, (RANGE, "None")), 0, "one word in capitals"),
        Wrong("small", changed(REPORT, (RANGE, '"localhost"')), 0, "one word in capitals"),
        Wrong("elsewhere", ELSEWHERE, 0, "What a cell writes there later moves no node"),
        Wrong("true", changed(REPORT, ('int(os.environ["ROS_DOMAIN_ID"])', "True")), 0, "You gave True."),
        Wrong("no_domain", changed(REPORT, ('int(os.environ["ROS_DOMAIN_ID"])', "None")), 0, "You gave None."),
    ],
    REPORTS,
)
