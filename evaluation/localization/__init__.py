"""Turns a map and a robot that wanders somewhere on it into how soon and how well it is found."""
