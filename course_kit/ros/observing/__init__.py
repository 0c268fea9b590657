"""An observer of a ROS domain: its graph, the messages of its topics, the logs of its nodes."""
