"""Turns combinations of settings into run folders, and run folders into tables and a page."""
