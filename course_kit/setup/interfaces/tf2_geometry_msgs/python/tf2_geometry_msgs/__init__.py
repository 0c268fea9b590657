"""Messages of geometry_msgs in other frames; importing it registers them. The course's; robots/tf does the work."""

from tf2_geometry_msgs.tf2_geometry_msgs import *  # noqa: F403 - the module has an __all__
from tf2_geometry_msgs.tf2_geometry_msgs import __all__ as __all__
