"""Causes in what tf2 says of transforms that cannot be had."""

from __future__ import annotations

from course_kit.ros.causes.raised import Rule

RULES: tuple[Rule, ...] = (
    (
        "LookupException",
        r'^"(.+)" passed to .* does not exist',
        r"No transform that names \1 has come to this buffer: before the first have come, that is no error, so catch "
        r"TransformException and try again; if it stays so, nobody sends it, or under another name",
    ),
    (
        "LookupException",
        r"because it contains a loop",
        "Each frame has one parent, and the way up ends at one that has none: of the transforms above, one has its "
        "header.frame_id and child_frame_id the wrong way round",
    ),
    (
        "ConnectivityException",
        r"between '(.+)' and '(.+)' because",
        r"\1 and \2 are both known, but no transform leads from the tree of one to that of the other: start the node "
        r"that sends it; all_frames_as_string() of the buffer shows which there are",
    ),
    (
        "ExtrapolationException",
        r"into the future",
        "The transform for that moment has not come yet, and tf2 does not guess: ask for rclpy.time.Time(), which is "
        "the latest, or wait with timeout=Duration(seconds=0.2). If the two times are far apart, one node goes by "
        "simulated time (use_sim_time) and another does not",
    ),
    (
        "ExtrapolationException",
        r"into the past",
        "The moment is before all that the buffer has heard, and it keeps 10 s: ask for rclpy.time.Time(), which is "
        "the latest, or skip messages that are older than the listener",
    ),
    (
        "ExtrapolationException",
        r"but only time",
        "Of one of the links one transform has come so far, and between two there are others: try again when more have "
        "come, or ask for rclpy.time.Time(), which is the latest",
    ),
    (
        "InvalidArgumentException",
        r'^Invalid argument "/(.+)" passed',
        r"Frames have no slash before their names in ROS 2: write '\1'",
    ),
    (
        "InvalidArgumentException",
        r'^Invalid argument "" passed',
        "The name of the frame is empty: often that of a message whose header.frame_id was not set",
    ),
    (
        "TypeException",
        r"class 'geometry_msgs.*is not loaded or supported",
        "A buffer does not know the types of geometry_msgs by itself: write import tf2_geometry_msgs, which tells it",
    ),
)
LOGGED = (
    (
        "TF_DENORMALIZED_QUATERNION",
        "The rotation is no quaternion of length 1, such as x = y = z = w = 0: no turn is rotation.w = 1.0",
    ),
    (
        "TF_OLD_DATA",
        "Either time has jumped back, as when a bag or a simulation starts anew, or two nodes send this frame and "
        "their clocks differ",
    ),
    (
        "TF_SELF_TRANSFORM",
        "A transform tells where child_frame_id is in header.frame_id, so the two are different frames",
    ),
)
