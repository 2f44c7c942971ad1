"""Turns a floor plan into a fast tour that sees it all, to measure explorers against."""
