"""Tells which compiled kernels a run needs, and has them compiled before it is measured."""
