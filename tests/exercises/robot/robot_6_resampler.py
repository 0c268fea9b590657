"""Answers to robot-6: right ones in several styles, and wrong ones that students give."""

from __future__ import annotations

from tests.exercises.chapter import Answers, Wrong, changed, worked

RESAMPLE = worked("robot-6")
CHOSEN = "np.searchsorted(ends, marks)"

WHEEL = """
import random
from geometry_msgs.msg import Point, Pose, PoseArray, Quaternion
from std_msgs.msg import Float64MultiArray, Header

def as_pose(x, y, heading):
    q = Quaternion(x=0.0, y=0.0, z=math.sin(heading / 2), w=math.cos(heading / 2))
    return Pose(position=Point(x=x, y=y, z=0.0), orientation=q)

class Resampler(Node):
    def __init__(self):
        super().__init__("resampler")
        self.out = self.create_publisher(PoseArray, "/resampled", 1)
        self.where = self.create_publisher(PoseStamped, "/estimate", 1)
        self.create_subscription(Float64MultiArray, "/particles", self.turn_the_wheel, 1)

    def turn_the_wheel(self, message):
        data = list(message.data)
        rows = [data[i : i + 4] for i in range(0, len(data), 4)]
        total = sum(row[3] for row in rows)
        step = total / len(rows)
        mark, end, i = random.random() * step, rows[0][3], 0
        drawn = []
        for _ in rows:
            while mark > end and i < len(rows) - 1:
                i += 1
                end += rows[i][3]
            drawn.append(rows[i])
            mark += step
        head = Header(frame_id='map', stamp=self.get_clock().now().to_msg())
        self.out.publish(PoseArray(header=head, poses=[as_pose(*row[:3]) for row in drawn]))
        mean = [sum(w * v for *_, w, v in [(r[3], f(r)) for r in rows]) / total for f in (
            lambda r: r[0], lambda r: r[1], lambda r: math.sin(r[2]), lambda r: math.cos(r[2]))]
        place = PoseStamped(header=head, pose=as_pose(mean[0], mean[1], math.atan2(mean[2], mean[3])))
        self.where.publish(place)
"""

RESIDUAL = """
from geometry_msgs.msg import PoseArray
from std_msgs.msg import Float64MultiArray

class Resampler(Node):
    def __init__(self):
        super().__init__("resampler")
        self.resampled = self.create_publisher(PoseArray, "resampled", 10)
        self.estimate = self.create_publisher(PoseStamped, "estimate", 10)
        self.create_subscription(Float64MultiArray, "particles", self.on_particles, 10)

    def on_particles(self, message):
        '''What is whole in n * weight is copied, the rest is drawn.'''
        rows = np.asarray(message.data).reshape(-1, 4)
        wanted = len(rows) * rows[:, 3] / rows[:, 3].sum()
        copies = np.floor(wanted).astype(int)
        missing = len(rows) - copies.sum()
        if missing:
            ends = np.cumsum(wanted - copies)
            marks = (np.arange(missing) + np.random.uniform()) * ends[-1] / missing
            copies += np.bincount(np.searchsorted(ends, marks), minlength=len(rows))[: len(rows)]
        new = np.repeat(rows[:, :3], copies, axis=0)
        cloud = PoseArray(poses=[pose_of(tuple(one)) for one in new.tolist()])
        share = wanted / len(rows)
        cloud.header.frame_id = 'map'
        self.resampled.publish(cloud)
        place = *(share @ rows[:, :2]), np.angle(share @ np.exp(1j * rows[:, 2]))
        self.estimate.publish(PoseStamped(header=cloud.header, pose=pose_of(tuple(map(float, place)))))
"""

ANSWERS = Answers(
    "robot-6",
    4,
    RESAMPLE,
    [
        Wrong(
            "multinomial",
            changed(RESAMPLE, (CHOSEN, "self.random.choice(len(x), size=len(x), p=weight / ends[-1])")),
            3,
            "With a draw for each particle",
        ),
        Wrong(
            "keeps_weights",
            changed(RESAMPLE, (CHOSEN, "range(len(x))")),
            2,
            "They are the particles that came",
        ),
        Wrong("argmax", changed(RESAMPLE, (CHOSEN, "[int(weight.argmax())] * len(x)")), 2, "All are copies of one"),
        Wrong(
            "mean_of_angles",
            changed(RESAMPLE, ("math.atan2(weight @ np.sin(heading), weight @ np.cos(heading))", "weight @ heading")),
            3,
            "add sines and cosines by weight",
        ),
        Wrong("no_chance", changed(RESAMPLE, ("self.random.uniform()", "0.5")), 3, "is drawn anew each time"),
        Wrong(
            "a_mark_each_by_chance",
            changed(RESAMPLE, ("self.random.uniform()", "self.random.uniform(size=len(x))")),
            3,
            "marks at equal distances",
        ),
        Wrong(
            "quaternion",
            changed(
                RESAMPLE,
                ("pose_of((x[i], y[i], heading[i]))", "pose_of((x[i], y[i], 2 * heading[i]))"),
            ),
            0,
            "is no particle's",
        ),
        Wrong("fewer", changed(RESAMPLE, ("(np.arange(len(x)) + ", "(np.arange(100) + ")), 0, "as many as came"),
        Wrong(
            "no_frame",
            changed(RESAMPLE, ('        place.header.frame_id = "map"\n', "")),
            3,
            "poses without their frame",
        ),
        Wrong(
            "no_estimate",
            changed(RESAMPLE, ("        self.estimate.publish(place)\n", "")),
            3,
            "Nothing came on /estimate",
        ),
        Wrong(
            "sum_is_one",
            changed(RESAMPLE, (" * ends[-1]", ""), (" / ends[-1]", "")),
            1,
            "Weights do not add up to 1 here",
        ),
    ],
    {"wheel": WHEEL, "residual": RESIDUAL},
)
