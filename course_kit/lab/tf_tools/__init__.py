"""The programs of `ros2 run tf2_ros …` and `ros2 run tf2_tools …`: transforms echoed, published, measured, drawn."""
