"""Turns laser scans, odometry and IMU readings into a pose and an occupancy grid, and scores both."""
