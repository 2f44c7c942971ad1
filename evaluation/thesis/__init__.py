"""Turns two simulated drives into one page: the thesis's figures, and whether they come out so."""
