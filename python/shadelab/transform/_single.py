"""A single element out of its domain is an error; in a batch it is NaN."""

from __future__ import annotations

import numpy as np

from .._arrays import Floats

__all__ = ["refuse"]


def refuse(name: str, given: Floats, result: Floats, expected: str) -> None:
    """Raises if one finite matrix gave NaN."""
    if given.ndim == 2 and np.isnan(result).any() and np.isfinite(given).all():
        raise ValueError(f"{name}: expected {expected}")
