"""Turns scans, odometry and gyroscope into maps that stay straight: fusion, matching, SLAM."""
