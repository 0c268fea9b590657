"""tf2: where frames are in each other, and were. tf2_ros, tf2_py, tf2_geometry_msgs and tf2_sensor_msgs use it."""
