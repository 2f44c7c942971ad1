"""Turns laser scans, odometry and IMU readings into a pose and an occupancy grid; scores both."""
