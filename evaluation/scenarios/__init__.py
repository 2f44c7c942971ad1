"""Turns scenario files into whole explorations with pass criteria, judged and tabled."""
