"""`ros2 service echo`: the calls of a service, as clients and servers with service introspection report them."""

from __future__ import annotations

from argparse import Namespace
from typing import Any

from course_kit.cli.ros2.messages.shown import SHOWN, shown
from course_kit.cli.ros2.named import SERVICES
from course_kit.cli.ros2.session import Session
from course_kit.cli.ros2.verbs import GRAPH, CommandError, Verb, did_you_mean, duration, flag

TICK = 0.05  # seconds without an event after which warnings are looked at
# What service_msgs/msg/ServiceEventInfo has as numbers.
EVENTS = dict(enumerate(("REQUEST_SENT", "REQUEST_RECEIVED", "RESPONSE_SENT", "RESPONSE_RECEIVED")))


def _run(args: Namespace, session: Session) -> None:
    from rclpy.qos import QoSPresetProfiles
    from rclpy.serialization import deserialize_message

    from course_kit.cli.ros2.topic import endpoints
    from course_kit.cli.ros2.topic.echo import Arrivals
    from course_kit.ros.subscriptions import observer_node, topics

    kind = _service_class(session, args).Event
    name = f"{args.service_name}/_service_event"
    topic, arrivals, node = endpoints.full_name(name), Arrivals(), session.node

    def note_mismatch(policy: Any) -> None:
        arrivals.warnings.put(endpoints.incompatible(node.get_name(), topic, policy, is_publisher=False))

    qos = QoSPresetProfiles.get_from_short_key("services_default")
    with endpoints.refused(topic):
        subscription = observer_node.subscribe_exactly(topic, arrivals.put, kind, qos, note_mismatch)
    try:
        timeout = topics.MATCH_TIMEOUT if topics.publishers(node, topic) else 0.0
        if not session.until(lambda: subscription.publisher_count, timeout):
            session.print(f"No publishers on topic '{name}'; is service introspection on the client or server enabled?")
        while True:
            arrivals.report(session, with_lost=False)
            for data, _ in session.items(arrivals.queue, timeout=TICK):
                session.print(event_text(deserialize_message(data, kind), args))
    finally:
        subscription.close(wait=False)


def _service_class(session: Session, args: Namespace) -> Any:
    """The type that is given, or else that of the service. CommandError if there is none, or several."""
    from course_kit.cli.ros2.messages.arguments import interface_class

    name, there = args.service_name, session.named("service", with_hidden=True)
    if args.service_type is None and name not in there:
        raise CommandError(f"Cannot find type for '{name}'", did_you_mean(name, there))
    types = [args.service_type] if args.service_type is not None else there[name]
    if len(types) > 1:
        raise CommandError(f"More than one type associated with service '{name}'")
    try:
        return interface_class(types[0], "srv")
    except CommandError as error:
        raise CommandError(f"The service type '{types[0]}' is invalid", error.suggestion) from None


def event_text(event: Any, args: Namespace) -> str:
    """What is printed of an event: YAML with the name of what happened; values with commas, which have its number."""
    from course_kit.cli.ros2.messages.yaml_text import dump, to_csv, to_dict

    if args.csv:
        return to_csv(event, shown(args))
    data = to_dict(event, shown(args))
    data["info"]["event_type"] = EVENTS.get(event.info.event_type, event.info.event_type)
    return f"{dump(data, args.flow_style)}---"


ECHO = Verb(
    "print the calls of a service, if its clients or its server publish them",
    _run,
    GRAPH,
    SERVICES.name,
    SERVICES.typed("service_type", nargs="?"),
    flag("--csv", "print the values separated by commas"),
    SHOWN,
    duration,
)
