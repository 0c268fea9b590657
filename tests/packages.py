"""Packages as the tutorials have them, written into the `src` of a workspace for the tests to build."""

from __future__ import annotations

from pathlib import Path

PACKAGE_XML = """<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.0.0</version>
  <description>A package of the tests</description>
  <maintainer email="student@example.com">student</maintainer>
  <license>Apache-2.0</license>
{dependencies}
  <export><build_type>{build_type}</build_type></export>
</package>
"""

SETUP_PY = """from glob import glob
from setuptools import find_packages, setup

package_name = 'demo_py'

setup(
    name=package_name,
    version='0.0.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        ('share/' + package_name + '/launch', glob('launch/*.launch.py')),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer='student',
    maintainer_email='student@example.com',
    description='A package of the tests',
    license='Apache-2.0',
    entry_points={
        'console_scripts': [
            'talker = demo_py.talker:main',
            'listener = demo_py.listener:main',
            'spotter = demo_py.spotter:main',
        ],
    },
)
"""
SETUP_CFG = """[develop]
script_dir=$base/lib/demo_py
[install]
install_scripts=$base/lib/demo_py
"""

TALKER = """import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):

    def __init__(self):
        super().__init__('talker')
        self.declare_parameter('words', 'Hello World')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.count = 0
        self.create_timer(0.05, self.tick)

    def tick(self):
        words = self.get_parameter('words').value
        self.publisher.publish(String(data=f'{words}: {self.count}'))
        self.count += 1


def main(args=None):
    rclpy.init(args=args)
    node = None
    try:
        node = Talker()
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        print('talker ends')
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
"""
LISTENER = """import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):

    def __init__(self):
        super().__init__('listener')
        self.create_subscription(String, 'chatter', self.heard, 10)

    def heard(self, message):
        self.get_logger().info(f'I heard: [{message.data}]')


def main(args=None):
    rclpy.init(args=args)
    node = None
    try:
        node = Listener()
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
"""
# A node that offers and publishes types of demo_interfaces.
SPOTTER = """import rclpy
from demo_interfaces.msg import Spot
from demo_interfaces.srv import Mark
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class Spotter(Node):

    def __init__(self):
        super().__init__('spotter')
        self.publisher = self.create_publisher(Spot, 'spots', 10)
        self.create_service(Mark, 'mark', self.mark)
        self.create_timer(0.05, lambda: self.publisher.publish(Spot(name='here', sizes=[1.0, 2.0])))

    def mark(self, request, response):
        response.text = f'{request.spot.name} at {request.spot.where.x}'
        return response


def main(args=None):
    rclpy.init(args=args)
    node = None
    try:
        node = Spotter()
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
"""
LAUNCH = """from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument('words', default_value='Good morning'),
        Node(package='demo_py', executable='talker', namespace='demo',
             parameters=[{'words': LaunchConfiguration('words')}]),
        Node(package='demo_py', executable='listener', namespace='demo', output='screen'),
    ])
"""

INTERFACES_CMAKE = """cmake_minimum_required(VERSION 3.8)
project(demo_interfaces)

find_package(ament_cmake REQUIRED)
find_package(geometry_msgs REQUIRED)
find_package(rosidl_default_generators REQUIRED)

rosidl_generate_interfaces(${PROJECT_NAME}
  "msg/Spot.msg"
  "srv/Mark.srv"
  "action/Walk.action"
  DEPENDENCIES geometry_msgs
)

ament_export_dependencies(rosidl_default_runtime)
ament_package()
"""
INTERFACES_DEPENDENCIES = """  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
  <depend>geometry_msgs</depend>
  <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>"""

CPP_CMAKE = """cmake_minimum_required(VERSION 3.8)
project(demo_cpp)

find_package(ament_cmake REQUIRED)

add_executable(hello src/hello.cpp)
install(TARGETS hello DESTINATION lib/${PROJECT_NAME})

ament_package()
"""
CPP = """#include <cstdio>

int main()
{
  printf("Hello from C++\\n");
  return 0;
}
"""


def write(folder: Path, files: dict[str, str]) -> None:
    """Write files, given by their paths in a folder."""
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def package_xml(name: str, build_type: str, dependencies: str = "") -> str:
    """A package.xml."""
    return PACKAGE_XML.format(name=name, build_type=build_type, dependencies=dependencies)


def add_python_package(src: Path) -> None:
    """demo_py: talker, listener and spotter, a launch file."""
    write(
        src / "demo_py",
        {
            "package.xml": package_xml("demo_py", "ament_python", "  <depend>rclpy</depend>"),
            "setup.py": SETUP_PY,
            "setup.cfg": SETUP_CFG,
            "resource/demo_py": "",
            "demo_py/__init__.py": "",
            "demo_py/talker.py": TALKER,
            "demo_py/listener.py": LISTENER,
            "demo_py/spotter.py": SPOTTER,
            "launch/demo.launch.py": LAUNCH,
        },
    )


def add_interface_package(src: Path) -> None:
    """demo_interfaces: a message, a service and an action."""
    write(
        src / "demo_interfaces",
        {
            "package.xml": package_xml("demo_interfaces", "ament_cmake", INTERFACES_DEPENDENCIES),
            "CMakeLists.txt": INTERFACES_CMAKE,
            "msg/Spot.msg": "string name\nfloat64[] sizes\ngeometry_msgs/Point where\n",
            "srv/Mark.srv": "Spot spot\n---\nstring text\n",
            "action/Walk.action": "float64 distance\n---\nbool arrived\n---\nfloat64 left\n",
        },
    )


def add_cpp_package(src: Path) -> None:
    """demo_cpp: an executable that needs no rclcpp."""
    dependencies = "  <buildtool_depend>ament_cmake</buildtool_depend>"
    write(
        src / "demo_cpp",
        {
            "package.xml": package_xml("demo_cpp", "ament_cmake", dependencies),
            "CMakeLists.txt": CPP_CMAKE,
            "src/hello.cpp": CPP,
        },
    )
