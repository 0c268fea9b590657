"""What `ros2 run tf2_ros …` and `ros2 run tf2_tools …` start: transforms echoed, published, measured, drawn."""
