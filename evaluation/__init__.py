"""Turns a world, a mapper and a navigator into a scored episode."""
