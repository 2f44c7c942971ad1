"""Every test run draws the same examples: what fails in CI fails here."""

import os

from hypothesis import settings

from evaluation.kernels.cache import forget_stale_kernels

os.environ.setdefault("MPLBACKEND", "Agg")

settings.register_profile("reproducible", derandomize=True, deadline=None, print_blob=False)
settings.load_profile("reproducible")
forget_stale_kernels()
