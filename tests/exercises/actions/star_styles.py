"""Right answers to actions-5 in other styles."""

from __future__ import annotations

STAR_STYLES = {
    "driven_by_the_poses": """
from rclpy.qos import qos_profile_sensor_data

class StarServer(Node):
    def __init__(self):
        Node.__init__(self, "star_server")
        self.jobs, self.newest = {}, None
        self.twist = self.create_publisher(Twist, "/turtle1/cmd_vel", 1)
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, qos_profile_sensor_data)
        self.server = ActionServer(self, Polygon, "drive_star", self.execute, handle_accepted_callback=self.on_accepted,
                                   cancel_callback=lambda handle: CancelResponse.ACCEPT)

    def on_accepted(self, handle):
        for job in self.jobs.values():
            if job["handle"].is_active:
                job["handle"].abort()
                job["done"].set_result(Polygon.Result(distance=job["driven"]))
        self.newest = bytes(handle.goal_id.uuid)
        self.jobs[self.newest] = {"handle": handle, "done": Future(), "driven": 0.0, "corners": None, "home": None}
        handle.execute()

    async def execute(self, handle):
        return await self.jobs[bytes(handle.goal_id.uuid)]["done"]

    def on_pose(self, pose):
        job = self.jobs.get(self.newest)
        if job is None or job["done"].done():
            return
        handle, side = job["handle"], job["handle"].request.side_length
        if job["home"] is None:  # the first line goes north, and it turns clockwise
            job["home"] = job["at"] = x, y = pose.x, pose.y
            job["corners"] = []
            for n in range(5):
                x += side * math.cos(math.pi / 2 - n * math.radians(144))
                y += side * math.sin(math.pi / 2 - n * math.radians(144))
                job["corners"].append((x, y))
        job["driven"] += math.dist(job["at"], (pose.x, pose.y))
        job["at"] = pose.x, pose.y
        if handle.is_cancel_requested:
            job["corners"] = [job["home"]]
        if math.dist(job["at"], job["corners"][0]) < 0.06:
            job["corners"].pop(0)
        if not job["corners"]:
            self.twist.publish(Twist())
            handle.canceled() if handle.is_cancel_requested else handle.succeed()
            job["done"].set_result(Polygon.Result(distance=job["driven"]))
            return
        self.twist.publish(steer(pose, *job["corners"][0]))
        handle.publish_feedback(Polygon.Feedback(distance_left=max(0.0, 5 * side - job["driven"])))
""",
    "blocking_in_threads": """
import threading
import time
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor

class StarServer(Node):
    def __init__(self):
        super().__init__("star_server")
        self.pose, self.latest, self.driving = None, None, threading.Lock()
        self.publisher = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "turtle1/pose", lambda pose: setattr(self, "pose", pose), 10,
                                 callback_group=MutuallyExclusiveCallbackGroup())
        self.server = ActionServer(self, Polygon, "drive_star", self.execute, handle_accepted_callback=self.accepted,
                                   cancel_callback=lambda handle: CancelResponse.ACCEPT)

    def accepted(self, handle):
        earlier, self.latest = self.latest, handle
        if earlier is not None and earlier.is_active:
            earlier.abort()
        handle.execute()

    def go(self, handle, x, y, further, is_wanted):
        while is_wanted():
            pose = self.pose
            left = math.dist((pose.x, pose.y), (x, y))
            if left < 0.08:
                return True
            turn = math.remainder(math.atan2(y - pose.y, x - pose.x) - pose.theta, math.tau)
            command = Twist()
            if abs(turn) > 0.06:
                command.angular.z = math.copysign(min(2.0, 4.0 * abs(turn)), turn)
            else:
                command.linear.x, command.angular.z = min(1.2, 2.0 * left + 0.1), 2.0 * turn
            self.publisher.publish(command)
            handle.publish_feedback(Polygon.Feedback(distance_left=left + further))
            time.sleep(0.02)
        return False

    def execute(self, handle):
        with self.driving:
            while self.pose is None:
                time.sleep(0.01)
            side, here = handle.request.side_length, self.pose
            point, heading = complex(here.x, here.y), here.theta
            for lines in (4, 3, 2, 1, 0):
                point += side * complex(math.cos(heading), math.sin(heading))
                heading += math.radians(144)
                if not self.go(handle, point.real, point.imag, lines * side,
                               lambda: handle.is_active and not handle.is_cancel_requested):
                    break
            else:
                self.publisher.publish(Twist())
                handle.succeed()
            if handle.is_cancel_requested:
                self.go(handle, here.x, here.y, 0.0, lambda: handle.is_active)
                self.publisher.publish(Twist())
                handle.canceled()
            return Polygon.Result(distance=5.0 * side)

star_server = run(StarServer, executor=MultiThreadedExecutor(num_threads=4))
""",
    "slow_steps_of_a_lifecycle_node": """
from rclpy.lifecycle import LifecycleNode

class Way:
    def __init__(self, pose, side):
        self.home, self.side, self.lines = (pose.x, pose.y), side, []
        x, y = self.home
        for n in range(5):
            angle = pose.theta - math.radians(n * 144 + 18)
            x, y = x + side * math.cos(angle), y + side * math.sin(angle)
            self.lines.append((x, y))

    def left(self, pose):
        return math.dist((pose.x, pose.y), self.lines[0]) + self.side * (len(self.lines) - 1)

class StarServer(LifecycleNode):
    period = 0.05

    def __init__(self):
        super().__init__("star_server")
        self.pose, self.driving = Pose(), None
        self.create_subscription(Pose, "turtle1/pose", self.on_pose, 1)
        self.commands = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.server = ActionServer(self, Polygon, "drive_star", self.execute, goal_callback=self.on_goal,
                                   cancel_callback=self.on_cancel)

    def on_pose(self, pose):
        self.pose = pose

    def on_goal(self, goal):
        return GoalResponse.ACCEPT if goal.side_length > 0 and goal.sides == 5 else GoalResponse.REJECT

    def on_cancel(self, handle):
        return CancelResponse.ACCEPT

    sleep = FibonacciServer.sleep

    def command(self, x, y):
        twist, pose = Twist(), self.pose
        turn = math.remainder(math.atan2(y - pose.y, x - pose.x) - pose.theta, math.tau)
        twist.angular.z = max(-2.5, min(2.5, 5.0 * turn))
        if abs(turn) < 0.15:
            twist.linear.x = min(1.0, 2.0 * math.dist((pose.x, pose.y), (x, y)) + 0.05)
        self.commands.publish(twist)

    def is_at(self, x, y):
        return math.dist((self.pose.x, self.pose.y), (x, y)) < 0.1

    async def execute(self, handle):
        if self.driving is not None and self.driving.is_active:
            self.driving.abort()
        self.driving = handle
        await self.sleep(0.05)
        way = Way(self.pose, handle.request.side_length)
        while way.lines and handle.is_active and not handle.is_cancel_requested:
            handle.publish_feedback(Polygon.Feedback(distance_left=way.left(self.pose)))
            self.command(*way.lines[0])
            await self.sleep(self.period)
            if self.is_at(*way.lines[0]):
                del way.lines[0]
        while handle.is_cancel_requested and not self.is_at(*way.home):
            self.command(*way.home)
            await self.sleep(self.period)
        if handle.is_active:
            self.commands.publish(Twist())
            handle.canceled() if handle.is_cancel_requested else handle.succeed()
        return Polygon.Result(distance=5 * way.side)
""",
}
