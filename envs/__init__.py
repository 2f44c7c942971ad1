"""Turns a floor plan into a simulated world, and wheel commands into sensor messages."""
