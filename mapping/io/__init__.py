"""Turns maps and trajectories into the files that ROS users have, and back."""
