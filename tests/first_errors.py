"""What beginners write, what they are to be told, and where in public somebody asked about it.

Sources are issues as repository#number, pull requests alike, and pages by their addresses.
"""

from __future__ import annotations

from textwrap import indent
from typing import NamedTuple

REVIEW = "review of the course in a browser"
SET_UP = """
import time
import rclpy
import std_msgs.msg
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from geometry_msgs.msg import Twist
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64, Float64MultiArray, String, UInt8
from geometry_msgs.msg import PointStamped, TransformStamped
from tf2_ros import Buffer, TransformBroadcaster, TransformListener
from course_kit import run, stop, wait_for

class Base(Node):
    def __init__(self):
        super().__init__("x")
        self.talker = self.create_publisher(String, "chatter", 10)
        self.begin()

    def begin(self):
        self.create_timer(0.05, self.tick)

class Server(Base):
    def begin(self):
        self.service = self.create_service(AddTwoInts, "add", self.add)
        self.client = self.create_client(AddTwoInts, "add")
        self.create_timer(0.05, self.ask)

    def ask(self):
        if self.client.service_is_ready():
            self.client.call_async(AddTwoInts.Request(a=1, b=2))

class Worker(Base):
    def begin(self):
        self.server = ActionServer(self, Fibonacci, "fibonacci", self.execute)
        self.client = ActionClient(self, Fibonacci, "fibonacci")
        self.is_sent = False
        self.create_timer(0.05, self.send)

    def send(self):
        if self.client.server_is_ready() and not self.is_sent:
            self.is_sent = True
            self.client.send_goal_async(Fibonacci.Goal(order=3))
"""


FRAMES = """
buffer = Buffer()
for child, parent, seconds in (("base", "odom", 5), ("base", "odom", 6), ("laser", "mast", 5)):
    link = TransformStamped(child_frame_id=child)
    link.header.frame_id, link.header.stamp.sec, link.transform.rotation.w = parent, seconds, 1.0
    buffer.set_transform(link, "a test")
"""


def lookup(target: str, source: str, seconds: int) -> str:
    """A cell that looks up a transform among a base in odom, known from second 5 to 6, and a laser on a mast."""
    return f"{FRAMES}buffer.lookup_transform({target!r}, {source!r}, rclpy.time.Time(seconds={seconds}))"


class Case(NamedTuple):
    """A cell that goes wrong."""

    name: str
    code: str  # where it defines X, that is run
    says: str  # the cause and the cure, as far as they are looked at
    source: str
    is_raised: bool = True  # else rclpy logs it, and a check sees what comes of it

    @property
    def is_class(self) -> bool:
        return self.code.startswith("class X(")


def method(name: str, body: str, arguments: str = "self", base: str = "Base") -> str:
    """A class X with one method."""
    return f"class X({base}):\n    def {name}({arguments}):\n{indent(body, ' ' * 8)}\n"


def tick(body: str) -> str:
    """A class X whose timer does this."""
    return method("tick", body)


def begin(body: str) -> str:
    """A class X whose constructor does this."""
    others = "\n    def tick(self):\n        pass\n\n    def heard(self, message):\n        pass\n"
    return method("begin", body) + others


CASES = (
    # Callbacks.
    Case(
        "callback without self",
        method("tick", "pass", ""),
        "tick() takes no self, and Python hands each method its object first: write def tick(self):",
        REVIEW,
    ),
    Case(
        "callback of a subscription without self",
        "class X(Base):\n    def begin(self):\n        self.create_subscription(String, 'chatter', self.heard, 10)\n\n"
        "    def heard(message):\n        pass\n",
        "heard() takes no self, and Python hands each method its object first: write def heard(self, message):",
        REVIEW,
    ),
    Case(
        "call in place of a callback",
        begin("self.create_timer(0.05, self.tick())"),
        "create_timer() got None as its callback, as a method gives that is called right there: hand over the method "
        "itself, without parentheses behind its name",
        REVIEW,
    ),
    Case(
        "callback of a subscription without message",
        "class X(Base):\n    def begin(self):\n        self.create_subscription(String, 'chatter', self.heard, 10)\n\n"
        "    def heard(self):\n        pass\n",
        "rclpy calls heard(message), and it is defined as heard(self): write def heard(self, message):",
        "ros2/ros2cli#731",
    ),
    Case(
        "callback of a timer with a message",
        method("tick", "pass", "self, message"),
        "rclpy calls tick(), and it is defined as tick(self, message): write def tick(self):",
        "ros2/rclpy#1265",
    ),
    Case(
        "callback of a service without response",
        method("add", "return request", "self, request", "Server"),
        "rclpy calls add(request, response), and it is defined as add(self, request)",
        "ros2/rclpy#464",
    ),
    Case(
        "lambda without the message",
        begin("self.create_subscription(String, 'chatter', lambda: self.tick(), 10)"),
        "rclpy calls the callback with (message), which this lambda does not take: write lambda message: …",
        "ros2/ros2cli#731",
    ),
    Case(
        "arguments of create_timer in the wrong order",
        begin("self.create_timer(self.tick, 0.5)"),
        "create_timer() got float 0.5 where its callback belongs: write create_timer(0.5, self.tick)",
        "ros2/rclpy#1265",
    ),
    Case(
        "period of a timer as text",
        begin("self.create_timer('fast', self.tick)"),
        "The period of a timer is a number of seconds, and comes first",
        "ros2/rclpy#54",
    ),
    Case(
        "misspelt callback",
        begin("self.create_timer(0.5, self.tik)"),
        "X has no tik: did you mean self.tick?",
        "ros2/demos#603",
    ),
    # Nodes.
    Case(
        "no super().__init__()",
        "class X(Node):\n    def __init__(self):\n        self.create_timer(1.0, self.tick)\n\n"
        "    def tick(self):\n        pass\n",
        "The constructor of X has not called Node's: write super().__init__('x') as the first line of __init__",
        REVIEW,
    ),
    Case(
        "no super().__init__() and nothing else of the node",
        "class X(Node):\n    def __init__(self):\n        self.count = 0\n",
        "The constructor of X has not called Node's",
        REVIEW,
    ),
    Case(
        "no name for the node",
        "class X(Node):\n    def __init__(self):\n        super().__init__()\n",
        "A node needs a name: write super().__init__('talker')",
        "https://docs.ros2.org/latest/api/rclpy/api/node.html",
    ),
    Case(
        "self handed to super().__init__()",
        "class X(Node):\n    def __init__(self):\n        super().__init__(self, 'x')\n",
        "super() hands the object over by itself",
        "https://docs.ros2.org/latest/api/rclpy/api/node.html",
    ),
    Case(
        "space in the name of a node",
        "class X(Node):\n    def __init__(self):\n        super().__init__('my node')\n",
        "The name of a node has letters, digits and _ only, no digit first: write 'my_node'",
        "ros2-dotnet/ros2_dotnet#14",
    ),
    Case(
        "namespace in the name of a node",
        "class X(Node):\n    def __init__(self):\n        super().__init__('robot1/x')\n",
        "The name of a node has no / in it, its namespace goes apart: write super().__init__('x', namespace='robot1')",
        "ros2/rclpy#86",
    ),
    Case(
        "method of the node without self",
        tick("get_logger().info('here')"),
        "get_logger belongs to the node, and Python does not look there by itself: write self.get_logger",
        "osrf/rosbook#41",
    ),
    Case(
        "attribute that was never set",
        tick("self.counter += 1"),
        "X has no counter: set self.counter in __init__, before anything uses it",
        "4am-robotics/cob_command_tools#95",
    ),
    Case(
        "print-style logging",
        tick("self.get_logger().info('count', 5)"),
        "A logger takes one text, unlike print(): put the values into it, as in info(f'x is {x}')",
        "ros/ros_comm#1222",
    ),
    Case(
        "number logged",
        tick("self.get_logger().info(5)"),
        "A logger takes text and nothing else: write info(str(value))",
        "UniversalRobots/Universal_Robots_ROS2_Driver#265",
    ),
    Case(
        "get_logger without parentheses",
        tick("self.get_logger.info('here')"),
        "get_logger is a method, which gives the logger when it is called: write get_logger().info(…)",
        "rollthecloudinc/hedge#240",
    ),
    Case(
        "node made before anything ran",
        "rclpy.shutdown()\nrun(Base())",
        "ROS has not been started in this kernel: hand the class to run(), which starts it",
        "ros2/rclpy#84",
    ),
    Case(
        "shutdown twice",
        "rclpy.init()\nrclpy.shutdown()\nrclpy.shutdown()",
        "ROS does not run in this kernel any more, so there is nothing to shut down: leave this shutdown() out",
        "ros2/rclpy#1081",
    ),
    Case(
        "publisher of a node that was stopped",
        "gone = run(Node, 'gone')\ntalker = gone.create_publisher(String, 'chatter', 10)\nstop(gone)\n"
        "talker.publish(String())",
        "Its node has been destroyed",
        "ros2/rclpy#837",
    ),
    Case(
        "spinning in a callback",
        tick("rclpy.spin_once(self)"),
        "/x already runs in the background, so it cannot be spun here too",
        "ros2/rclpy#1211",
    ),
    # Messages.
    Case(
        "class in place of a message",
        tick("self.talker.publish(String)"),
        "publish() sends a message, and String is the class of them: write String(data=…)",
        REVIEW,
    ),
    Case(
        "number in place of a message",
        tick("self.talker.publish(42)"),
        "publish() sends a message of the type String, not an int: write publish(String(data=…))",
        "ros2/rclpy#314",
    ),
    Case(
        "message of another type",
        tick("self.talker.publish(Float64(data=1.0))"),
        "This publisher was made for String and cannot send a Float64",
        "ros2/rclpy#314",
    ),
    Case(
        "field by place",
        tick("self.talker.publish(String('hello'))"),
        "The fields of a message are given by name: write String(data=…)",
        "rospypi/rosidl_generator_mypy#4",
    ),
    Case(
        "whole number in a float field",
        tick("command = Twist()\ncommand.linear.x = 2"),
        "The field x is a float and got 2, an int: write 2.0",
        "usnistgov/ARIAC#306",
    ),
    Case(
        "number in a text field",
        tick("self.talker.publish(String(data=5))"),
        "The field data is a str and got 5, an int: write str(…)",
        "ros2/rosidl_python#172",
    ),
    Case(
        "tuple in a whole-number field",
        tick("UInt8().data = (1,)"),
        "The field data is an int and got (1,), a tuple: write int(…)",
        "ros2/rclpy#1297",
    ),
    Case(
        "number that does not fit a field",
        tick("UInt8().data = 300"),
        "The field data takes a whole number in [0, 255], and got 300, an int",
        "ros2/rcl_interfaces#145",
    ),
    Case(
        "number in place of a list",
        tick("Float64MultiArray(data=1.0)"),
        "The field data takes a list, and got 1.0, a float: write [1.0]",
        "abizovnuralem/go2_ros2_sdk#139",
    ),
    Case(
        "numbers in a list of texts",
        tick("JointState(name=[1, 2])"),
        "The field name takes a list, whose values are of the type str",
        "abizovnuralem/go2_ros2_sdk#139",
    ),
    Case(
        "number in place of a part",
        tick("command = Twist()\ncommand.linear = 1.0"),
        "The field linear is a message itself, a Vector3, and got 1.0, a float",
        "ros2/rosidl#224",
    ),
    Case(
        "field of a part",
        tick("command = Twist()\ncommand.x = 1.0"),
        "Twist has no field x itself, its linear has: write .linear.x",
        "ros2/rosidl_python#20",
    ),
    Case(
        "field that is not there",
        tick("message = String()\nmessage.text = 'hello'"),
        "String has no field text; it has `data`",
        "DFKI-NI/rospy_message_converter#55",
    ),
    Case(
        "field that is not there, in the constructor",
        tick("self.talker.publish(String(text='hello'))"),
        "String has no field text; it has `data`",
        "DFKI-NI/rospy_message_converter#55",
    ),
    # Publishers, subscriptions, and their types.
    Case(
        "publisher without QoS",
        begin("self.create_publisher(String, 'said')"),
        "The QoS is missing, the last argument: end the call with , 10",
        "FurqanHabibi/joystick_ros2#4",
    ),
    Case(
        "subscription without QoS",
        begin("self.create_subscription(String, 'chatter', self.heard)"),
        "The QoS is missing, the last argument",
        "ros-teleop/teleop_tools#59",
    ),
    Case(
        "QoS as text",
        begin("self.create_publisher(String, 'said', 'reliable')"),
        "The QoS, the last argument, is the depth of a queue or a QoSProfile, and got a str",
        "ros2/rclpy#882",
    ),
    Case(
        "policy in place of a QoS",
        begin("self.create_publisher(String, 'said', ReliabilityPolicy.BEST_EFFORT)"),
        "ReliabilityPolicy.BEST_EFFORT is one policy, and the QoS is all of them: write QoSProfile(depth=10, "
        "reliability=ReliabilityPolicy.BEST_EFFORT)",
        "ros2/ros2cli#238",
    ),
    Case(
        "message in place of its class",
        begin("self.create_subscription(String(), 'chatter', self.heard, 10)"),
        "create_subscription() takes the class String, and this is one message: write String without parentheses",
        "ros2/rclpy#317",
    ),
    Case(
        "field of a class",
        tick("message = Bool\nmessage.data = True\nBool(data=False)"),
        "A cell has set data of the class Bool itself, for want of the parentheses in Bool(): restart the kernel",
        "ros2/rosidl_python#20",
    ),
    Case(
        "name before the type",
        begin("self.create_publisher('said', String, 10)"),
        "create_publisher() takes the type first, then the name as text",
        "ros2/rclpy#317",
    ),
    Case(
        "callback before the name",
        begin("self.create_subscription(String, self.heard, 'chatter', 10)"),
        "create_subscription() got str 'chatter' where its callback belongs",
        "ros2/rclpy#317",
    ),
    Case(
        "module in place of a type",
        begin("self.create_publisher(std_msgs.msg, 'said', 10)"),
        "A type is a class, and this is a module",
        "ros2/ros2#451",
    ),
    Case(
        "Python's type in place of a message's",
        begin("self.create_publisher(str, 'said', 10)"),
        "A topic carries messages, and this is no type of them",
        "aniskoubaa/rosgpt#8",
    ),
    Case(
        "service in place of a message",
        begin("self.create_publisher(AddTwoInts, 'said', 10)"),
        "AddTwoInts is a type of services, and create_publisher() and create_subscription() take a type of messages",
        "ros2/rclpy#317",
    ),
    Case(
        "message in place of a service",
        begin("self.create_client(String, 'said')"),
        "String is a type of messages, and create_service() and create_client() take a type of services",
        "ros2/rclpy#317",
    ),
    Case(
        "space in the name of a topic",
        begin("self.create_publisher(String, 'my topic', 10)"),
        "write 'my_topic'",
        "open-rmf/rmf_simulation#109",
    ),
    Case(
        "digit first in a part of a topic's name",
        begin("self.create_publisher(String, '/entity/1/pose', 10)"),
        "no part begins with a digit or is empty: write '/entity/n1/pose'",
        "ros2/rclpy#600",
    ),
    # Services.
    Case(
        "service without return",
        method("add", "response.sum = request.a + request.b", "self, request, response", "Server"),
        "The callback of a service returned None in place of its response: end it with return response",
        "ros2/rclpy#464",
    ),
    Case(
        "service that returns the value",
        method("add", "return request.a + request.b", "self, request, response", "Server"),
        "The callback of a service returned a value of the type int in place of its response",
        "ros2/rclpy#464",
    ),
    Case(
        "blocking call in a callback",
        method("ask", "self.client.call(AddTwoInts.Request())", base="Server")
        + "\n    def add(self, request, response):\n        return response\n",
        "client.call() inside a callback would wait for ever",
        "https://karelics.fi/deadlocks-in-rclpy/",
    ),
    Case(
        "class in place of a request",
        method("ask", "self.client.call_async(AddTwoInts.Request)", base="Server")
        + "\n    def add(self, request, response):\n        return response\n",
        "A call takes one request, and AddTwoInts_Request is a class: make one with AddTwoInts.Request()",
        "ros2/rclpy#317",
    ),
    Case(
        "values in place of a request",
        method("ask", "self.client.call_async(1, 2)", base="Server")
        + "\n    def add(self, request, response):\n        return response\n",
        "A call takes one request, whose fields hold the values",
        "ros2/rclpy#317",
    ),
    Case(
        "response read from the future",
        method("ask", "self.client.call_async(AddTwoInts.Request()).sum", base="Server")
        + "\n    def add(self, request, response):\n        return response\n",
        "call_async() gives a future at once, and sum comes with the response",
        "ros2/rclpy#884",
    ),
    Case(
        "result before it has come",
        method("ask", "self.client.call_async(AddTwoInts.Request()).result().sum", base="Server")
        + "\n    def add(self, request, response):\n        return response\n",
        "result() of a future is None until the answer has come",
        "ros2/rclpy#884",
    ),
    # Actions.
    Case(
        "action without result",
        method("execute", "goal_handle.succeed()", "self, goal_handle", "Worker"),
        "The execute callback of an action returned something else than its result: end it with return "
        "Fibonacci.Result(…)",
        "ros2/rclpy#270",
    ),
    Case(
        "class in place of feedback",
        method("execute", "goal_handle.publish_feedback(Fibonacci.Feedback)", "self, goal_handle", "Worker"),
        "Feedback is a message of its action: make one, as with Fibonacci.Feedback()",
        "ros2/rclpy#790",
    ),
    Case(
        "execute callback without goal handle",
        method("execute", "return Fibonacci.Result()", base="Worker"),
        "rclpy calls execute(goal_handle), and it is defined as execute(self)",
        "ros2/rclpy#1219",
    ),
    Case(
        "goal as a number",
        method("send", "self.client.send_goal_async(3)", base="Worker")
        + "\n    def execute(self, goal_handle):\n        pass\n",
        "A goal is a message of its action, not this value: write send_goal_async(Fibonacci.Goal(…))",
        "ros2/rclpy#317",
    ),
    Case(
        "action that is left open",
        method("execute", "return Fibonacci.Result()", "self, goal_handle", "Worker"),
        "The execute callback of an action returned without saying how it went: call goal_handle.succeed() before",
        "rollthecloudinc/hedge#240",
        is_raised=False,
    ),
    # Parameters.
    Case(
        "parameter that was not declared",
        tick("self.get_parameter('speed').value"),
        "A node declares its parameters before it uses them: write self.declare_parameter('speed', 1.0)",
        "ros/joint_state_publisher#20",
    ),
    Case(
        "parameter declared twice",
        begin("self.declare_parameter('speed', 1.0)\nself.declare_parameter('speed', 2.0)"),
        "The parameter speed is declared twice, and a node allows it once",
        "ros2/rclpy#501",
    ),
    Case(
        "whole number for a float parameter",
        "class X(Node):\n    def __init__(self):\n"
        "        super().__init__('x', parameter_overrides=[Parameter('speed', value=2)])\n"
        "        self.declare_parameter('speed', 1.0)\n",
        "The parameter speed was declared as DOUBLE and cannot become INTEGER: give it 2.0",
        "ros-controls/ros2_control_demos#600",
    ),
    Case(
        "parameter without .value",
        begin("self.declare_parameter('speed', 1.0)\nself.get_parameter('speed') * 2"),
        "get_parameter() gives the parameter, and its value is in .value",
        "ros2/rclpy#321",
    ),
    # Transforms.
    Case(
        "frame that nobody sends",
        lookup("map", "base", 0),
        "No transform that names map has come to this buffer",
        "mgonzs13/yolo_ros#21",
    ),
    Case(
        "two trees of frames",
        lookup("odom", "laser", 0),
        "odom and laser are both known, but no transform leads from the tree of one to that of the other",
        "appliedAI-Initiative/orb_slam_2_ros#134",
    ),
    Case(
        "transform of a moment to come",
        lookup("odom", "base", 7),
        "The transform for that moment has not come yet, and tf2 does not guess: ask for rclpy.time.Time()",
        "ros-perception/perception_pcl#416",
    ),
    Case(
        "transform of a moment before",
        lookup("odom", "base", 4),
        "The moment is before all that the buffer has heard, and it keeps 10 s",
        "ros2/geometry2#608",
    ),
    Case(
        "frames in a loop",
        FRAMES.replace('("laser", "mast", 5)', '("odom", "base", 6), ("laser", "mast", 5)')
        + "buffer.lookup_transform('mast', 'base', rclpy.time.Time())",
        "Each frame has one parent, and the way up ends at one that has none",
        "rai-opensource/spot_ros2#374",
    ),
    Case(
        "slash before a frame",
        lookup("/odom", "base", 0),
        "Frames have no slash before their names in ROS 2: write 'odom'",
        "ros-simulation/stage_ros#68",
    ),
    Case(
        "type that is not registered",
        f"{FRAMES}point = PointStamped()\npoint.header.frame_id = 'base'\nbuffer.transform(point, 'odom')",
        "A buffer does not know the types of geometry_msgs by itself: write import tf2_geometry_msgs",
        "ros2/geometry2#701",
    ),
    Case(
        "rotation of zeros",
        "class X(Base):\n    def begin(self):\n        self.buffer = Buffer()\n"
        "        self.listener = TransformListener(self.buffer, self)\n"
        "        self.broadcaster = TransformBroadcaster(self)\n"
        "        self.create_timer(0.2, self.tick)\n\n"
        "    def tick(self):\n        link = TransformStamped(child_frame_id='base')\n"
        "        link.header.frame_id = 'odom'\n        link.transform.rotation.w = 0.0\n"
        "        self.broadcaster.sendTransform(link)\n",
        "no turn is rotation.w = 1.0",
        "robomechanics/quad-sdk#346",
        is_raised=False,
    ),
    # Names and imports.
    Case(
        "answer in a fresh kernel",
        "class Y(Nodes):\n    pass",
        "No cell that has run in this kernel made Nodes: did you mean Node?",
        REVIEW,
    ),
    Case(
        "name that nothing is like",
        "zzz_corners",
        "No cell that has run in this kernel made zzz_corners: after a restart of the kernel, run the cells above",
        REVIEW,
    ),
    Case(
        "misspelt package",
        "from std_msg.msg import String",
        "There is no package std_msg: did you mean std_msgs?",
        "ros2/ros2cli#557",
    ),
    Case(
        "message from the package",
        "from std_msgs import String",
        "String is in std_msgs.msg: write from std_msgs.msg import String",
        "miguelriemoliveira/psr_21-22#68",
    ),
    Case(
        "service from the messages",
        "from example_interfaces.msg import AddTwoInts",
        "AddTwoInts is in example_interfaces.srv: write from example_interfaces.srv import AddTwoInts",
        "ros/ros_comm#320",
    ),
    Case(
        "misspelt message",
        "from std_msgs.msg import Strin",
        "std_msgs.msg has no Strin: did you mean String?",
        "ros/ros_comm#320",
    ),
)
