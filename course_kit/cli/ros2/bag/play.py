"""`ros2 bag play`: publishes a bag as it was recorded."""

from __future__ import annotations

from argparse import ArgumentTypeError, Namespace
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from typing import TYPE_CHECKING, Any

from course_kit.cli.ros2.bag import options
from course_kit.cli.ros2.bag.options import EXCLUDE_REGEX, REGEX, SHARED, failing_with
from course_kit.cli.ros2.session import DurationOver, Session
from course_kit.cli.ros2.verbs import LONGEST, Verb, argument, duration, flag, number, one_of, whole

if TYPE_CHECKING:
    from course_kit.lab.bags.files import OpenBag
    from course_kit.lab.bags.player import PlayOptions

RATES = {"up": 1.1, "down": 0.9}  # what these keys multiply the rate with
UNSUPPORTED: dict[str, dict[str, Any]] = {
    "--storage-config-file": {},
    "--service-requests-source": {},
    "--message-order": {},
}
KEY_LINES = (
    "Adding keyboard callbacks.",
    "Press SPACE for Pause/Resume",
    "Press CURSOR_RIGHT for Play Next Message",
    "Press CURSOR_UP for Increase Rate 10%",
    "Press CURSOR_DOWN for Decrease Rate 10%",
)


def _float(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise ArgumentTypeError(f"{text} is not the valid type (float)") from None


SLOWEST, FASTEST = 1e-6, 1e6  # times as fast as recorded, and Hz of /clock
_positive = number(_float, lambda value: value >= SLOWEST, "{} is not in the valid range (> 0.0)", FASTEST)
_not_negative = number(_float, lambda value: value >= 0, "Value {} is less than zero.", LONGEST)
_moment = number(int, lambda value: True, "invalid int value: {!r}")
_span = number(float, lambda value: True, "invalid float value: {!r}", LONGEST)


def _play(args: Namespace, session: Session) -> int:
    options.refuse_unsupported(args, UNSUPPORTED)
    paths, wanted = options.bag_paths(args), _options(args)

    from course_kit.cli.ros2.bag.keys import keys
    from course_kit.lab.bags.files import opened
    from course_kit.lab.bags.storage import BagError
    from course_kit.lab.bags.together import together

    has_keys = not (session.in_notebook or args.disable_keyboard_controls)
    with failing_with(BagError), ExitStack() as stack:
        bags = [stack.enter_context(opened(path)) for path in paths]
        for bag in bags:
            options.say_what_is_left(bag, session)
        pressed = stack.enter_context(keys(has_keys))
        return _run(together(bags), wanted, session, pressed if has_keys else None, args.log_level)


def _run(
    bag: OpenBag, wanted: PlayOptions, session: Session, pressed: Callable[[], str | None] | None, log_level: str
) -> int:
    """Play until the end, or until something ends it."""
    from course_kit.lab.bags.player import Player
    from course_kit.ros.subscriptions import topics

    with failing_with(ValueError):
        player = Player(bag, wanted, partial(options.show, session=session, log_level=log_level))
    for text in KEY_LINES if pressed else ():
        player.say(text)

    def tick() -> None:
        session.check_time()
        key = pressed() if pressed else None
        if key == " ":
            player.toggle_pause()
        elif key == "right":
            player.play_next()
        elif key in RATES:
            player.set_rate(player.clock.rate * RATES[key])

    try:
        session.graph()  # who listens already gets the first message too
        session.until(lambda: player.is_matched, topics.MATCH_TIMEOUT)
        player.play(tick)
        return 0
    except (SystemExit, KeyboardInterrupt, DurationOver) as ending:
        player.say("Stopping playback.")
        if isinstance(ending, SystemExit):
            return 0
        raise
    finally:
        player.close()


def _options(args: Namespace) -> PlayOptions:
    """What the command line asks for; CommandError for what cannot be."""
    from course_kit.lab.bags.player import PlayOptions
    from course_kit.lab.bags.selection import Selection
    from course_kit.ros.subscriptions import topics

    remap = {}
    with failing_with(ValueError):
        clock_topics = Selection([topics.absolute(name) for name in args.clock_topics], every=args.clock_topics_all)
        for rule in args.remap:
            old, separator, new = rule.partition(":=")
            if not separator:
                raise ValueError(f"'{rule}' is no remapping: write it like '/old_topic:=/new_topic'")
            remap[topics.absolute(old)] = topics.absolute(new)
    return PlayOptions(
        rate=args.rate,
        loop=args.loop,
        delay=args.delay,
        start_offset=args.start_offset,
        duration=None if args.playback_duration < 0 else args.playback_duration,
        selection=options.selection(args, args.topics, every=not (args.topics or args.services or args.regex)),
        remap=remap,
        overrides=options.qos_overrides(args.qos_profile_overrides_path),
        until=min((t for t in (int(args.playback_until_sec * 1e9), args.playback_until_nsec) if t >= 0), default=None),
        clock_rate=args.clock,
        clock_topics=clock_topics,
        read_ahead=args.read_ahead_queue_size,
        starts_paused=args.start_paused,
        sends_requests=args.publish_service_requests,
    )


PLAY = Verb(
    "publish the messages of a bag, at the pace of the recording",
    _play,
    options.BAGS,
    argument(
        "--read-ahead-queue-size",
        "read N messages ahead (default: 1000)",
        type=whole,
        default=1000,
    ),
    argument("-r --rate", "the speed: 2 is twice as fast (default: 1)", type=_positive, default=1.0),
    argument("--topics", "play only these topics", default=[], metavar="topic", nargs="+"),
    argument("--services", "play only the calls of these services", default=[], metavar="service", nargs="+"),
    REGEX,
    EXCLUDE_REGEX,
    argument("--exclude-topics", "leave these topics out", default=[], metavar="topic", nargs="+"),
    argument("--exclude-services", "leave the calls of these services out", default=[], metavar="service", nargs="+"),
    flag("--publish-service-requests", "call the services again, in place of publishing the events of their calls"),
    SHARED,
    flag("-l --loop", "begin again at the end"),
    argument("--remap -m", "publish topics under other names: /old:=/new …", default=[], nargs="+"),
    argument(
        "--clock", "publish /clock, N times a second (default: 40)", type=_positive, nargs="?", const=40.0, default=0
    ),
    one_of(
        argument("--clock-topics", "publish /clock with each message of these topics", default=[], nargs="+"),
        flag("--clock-topics-all", "publish /clock with each message"),
    ),
    argument("-d --delay", "wait N seconds before each start", type=_not_negative, default=0.0),
    argument("--playback-duration", "play N seconds of the bag (default: all)", type=_span, default=-1.0),
    one_of(
        argument("--playback-until-sec", "end at this time of the bag, in s since 1970", type=_span, default=-1.0),
        argument("--playback-until-nsec", "end at this time of the bag, in ns since 1970", type=_moment, default=-1),
    ),
    flag("-p --start-paused", "start paused; SPACE goes on"),
    argument("--start-offset", "start N seconds into the bag", type=_not_negative, default=0.0),
    argument("--wait-for-all-acked", "ignored: it always waits, for up to 1 s", type=whole, metavar="TIMEOUT"),
    flag("--disable-loan-message", "ignored: messages are never loaned"),
    duration,
    options.unsupported(UNSUPPORTED),
)
