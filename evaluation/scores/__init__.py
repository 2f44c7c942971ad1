"""Turns a run's map and poses into scores beside those of ``mapping``."""
