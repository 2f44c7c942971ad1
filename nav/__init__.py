"""Turns an occupancy grid, a pose and a scan into a velocity command."""
