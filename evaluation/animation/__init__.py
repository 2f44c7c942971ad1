"""Turns an episode into a moving picture of its map as it grew."""
