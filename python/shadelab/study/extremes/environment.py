"""Extremes of `environment`: one bright pixel, poles, the seam."""

from __future__ import annotations

import math

import numpy as np

from ...environment import Environment
from ..stability import Measurement, extreme


@extreme(
    "environment.Environment.sample",
    "one pixel of 1e6 among ones",
    domain="64 × 32 pixels; the spread of radiance over density, relative to its mean",
    unit="relative",
    claim=0.03,
)
def _bright(dtype: np.dtype) -> Measurement:
    sky = np.ones((32, 64), dtype)
    sky[9, 60] = 1e6
    u = (np.stack(np.meshgrid(np.arange(64), np.arange(64)), -1).reshape(-1, 2) + 0.5) / 64
    _, radiance, pdf = Environment(sky).sample(u.astype(dtype))
    share = radiance[:, 0].astype(np.float64) / pdf
    return Measurement(float(share.std() / share.mean()), len(u), int((~np.isfinite(share)).sum()))


@extreme(
    "environment.Environment",
    "poles, seam and the ends of the square",
    domain="directions at and 1e-7 about the poles and the seam, u at 0 and 1; values that are negative or not finite",
    unit="count",
    claim=0,
)
def _poles(dtype: np.dtype) -> Measurement:
    rng = np.random.default_rng(1)
    e = Environment(rng.gamma(0.5, 1.0, (7, 13, 3)).astype(dtype), rotation=0.3)
    eps = 1e-7
    seam = [(math.sin(a), 0.2, math.cos(a)) for a in (-eps, 0.0, eps)]
    d = np.array([(0, 1, 0), (0, -1, 0), (eps, 1, 0), (0, -1, -eps), *seam])
    d = (d / np.linalg.norm(d, axis=-1, keepdims=True)).astype(dtype)
    ends = np.array([0, 1 - np.finfo(dtype).eps / 2], dtype)
    wi, radiance, pdf = e.sample(np.stack(np.meshgrid(ends, ends), -1))
    values = np.concatenate([x.ravel() for x in (e.eval(d), e.pdf(d), radiance, pdf, np.abs(wi))])
    return Measurement(int((values < 0).sum()), values.size, int((~np.isfinite(values)).sum()))
