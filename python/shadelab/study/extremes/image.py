"""Extremes of `image`: error sums over many terms of very different size."""

from __future__ import annotations

import numpy as np

from ... import image
from ..stability import Measurement, extreme


@extreme(
    "image.rmse", "1e6 beside 4 million terms of 1e-4", domain="finite squares in double", unit="relative", claim=1e-12
)
def large_sum(dtype: np.dtype) -> Measurement:
    """Measure the sum against its closed form."""
    a = np.full((2048, 2048), 1e-4, dtype)
    a[7, 9] = 1e6
    small = np.longdouble(dtype.type(1e-4)) ** 2 * (a.size - 1)
    exact = np.sqrt((small + np.longdouble(1e12)) / a.size)
    got = image.rmse(a, np.zeros_like(a))
    return Measurement(float(abs(got - exact) / exact), a.size, int(not np.isfinite(got)))


@extreme("image.smape", "black, tiny and huge pixels", domain="all finite values", unit="absolute", claim=1e-15)
def bounded(dtype: np.dtype) -> Measurement:
    """Zero against zero is 0; anything against zero is 1; nothing overflows."""
    big, tiny = np.finfo(dtype).max / 4, np.finfo(dtype).tiny
    a = np.array([[0.0, big, tiny, big, -big]], dtype)
    b = np.array([[0.0, 0.0, 0.0, big, big]], dtype)
    got = image.smape(a, b)
    return Measurement(abs(got - 3 / 5), a.size, int(not np.isfinite(got)))
