"""Extremes of `brdf`: widths to the end of the exponent, grazing directions, the mirror direction itself."""

from __future__ import annotations

import mpmath
import numpy as np

from ... import brdf, sampling
from ..._arrays import Floats
from ..stability import Measurement, extreme


def _pairs(dtype: np.dtype) -> tuple[Floats, Floats]:
    """Pairs of directions: mirrored, near-mirrored, equal, opposite in azimuth, with cosines from 1 to 1e-7."""
    wi, wo = [], []
    for cosine in (1.0, 0.7, 1e-2, 1e-4, 1e-7):
        s = np.sqrt(1 - cosine * cosine)
        for turn in (0.0, 1e-6, 1e-3, 0.3, np.pi):
            wi.append([-s * np.cos(turn), -s * np.sin(turn), cosine])
            wo.append([s, 0.0, cosine])
        wi.append([0.0, 0.0, 1.0])
        wo.append([s, 0.0, cosine])
    return np.array(wi, dtype), np.array(wo, dtype)


def _exact_ggx(wi: Floats, wo: Floats, alpha: float, f0: float) -> tuple[mpmath.mpf, mpmath.mpf]:
    """The BRDF and the density at the given vectors, taken as unit."""
    i, o = [mpmath.mpf(float(x)) for x in wi], [mpmath.mpf(float(x)) for x in wo]
    h = [a + b for a, b in zip(i, o, strict=True)]
    squared = sum(x * x for x in h)
    a2 = mpmath.mpf(alpha) ** 2
    d = a2 / (mpmath.pi * ((a2 * h[2] ** 2 + h[0] ** 2 + h[1] ** 2) / squared) ** 2)
    si, so = (mpmath.sqrt(w[2] ** 2 + a2 * (w[0] ** 2 + w[1] ** 2)) for w in (i, o))
    fresnel = f0 + (1 - mpmath.mpf(f0)) * (1 - min(mpmath.sqrt(squared) / 2, mpmath.mpf(1))) ** 5
    return d * fresnel / (2 * (i[2] * so + o[2] * si)), d / (2 * (o[2] + so))


def _ggx_at(dtype: np.dtype, alphas: tuple[float, ...]) -> Measurement:
    wi, wo = _pairs(dtype)
    error, cases, strays = 0.0, 0, 0
    f0 = float(dtype.type(0.04))
    with mpmath.workdps(60):
        for alpha in alphas:
            width = dtype.type(alpha)
            f = brdf.ggx(wi, wo, np.array(width), np.full(3, f0, dtype))[:, 0]
            pdf = brdf.ggx_pdf(wi, wo, np.array(width))
            strays += int((~np.isfinite(f)).sum() + (~np.isfinite(pdf)).sum())
            for k in range(len(wi)):
                for got, exact in zip((f[k], pdf[k]), _exact_ggx(wi[k], wo[k], float(width), f0), strict=True):
                    # Values below the normal numbers of the precision have no relative accuracy to keep.
                    if exact > float(np.finfo(dtype).tiny):
                        error = max(error, float(abs(mpmath.mpf(float(got)) / exact - 1)))
                        cases += 1
    return Measurement(error / (float(np.finfo(dtype).eps) / 2), cases, strays)


@extreme(
    "brdf.ggx",
    "ordinary widths at grazing and at the mirror",
    domain="alpha 1 … 1e-4, cosines 1 … 1e-7; error in rounding units",
    unit="relative",
    claim=12,
)
def _ordinary(dtype: np.dtype) -> Measurement:
    return _ggx_at(dtype, (1.0, 0.999, 0.5, 1e-1, 1e-2, 1e-3, 1e-4))


@extreme(
    "brdf.ggx",
    "widths near the smallest",
    domain="alpha to 1e-9 (float32), 1e-70 (float64); error in rounding units",
    unit="relative",
    claim=12,
)
def _narrow(dtype: np.dtype) -> Measurement:
    return _ggx_at(dtype, (1e-6, 1e-9) if dtype == np.float32 else (1e-9, 1e-30, 1e-70))


@extreme(
    "brdf.ggx_sample",
    "ends of the square, every width",
    domain="u of 0, ulp, 1/2, 1 - ulp; alpha 1 … 1e-9; wo cosines 1 … 1e-7; |wi| - 1 in rounding units",
    unit="absolute",
    claim=8,
)
def _samples(dtype: np.dtype) -> Measurement:
    ends = np.array([0, np.finfo(dtype).eps, 0.5, 1 - np.finfo(dtype).eps / 2], dtype)
    u = np.stack(np.meshgrid(ends, ends), -1).reshape(-1, 1, 1, 2)
    _, wo = _pairs(dtype)
    alpha = np.array([1.0, 1e-2, 1e-4, 1e-9], dtype)[:, None]
    wi = brdf.ggx_sample(wo, u, alpha)
    length = np.sqrt((wi.astype(np.longdouble) ** 2).sum(-1))
    scale = np.sqrt((wo.astype(np.longdouble) ** 2).sum(-1))
    error = np.abs(length - scale).max() / (np.finfo(dtype).eps / 2)
    return Measurement(float(error), length.size, int((~np.isfinite(wi)).sum()))


@extreme(
    "brdf.metallic_roughness",
    "roughness 0 and 1, metallic 0 and 1, grazing",
    domain="corners of the parameters; no value negative or not finite, no sample heavier than 4",
    unit="count",
    claim=0,
)
def _corners(dtype: np.dtype) -> Measurement:
    _, wo = _pairs(dtype)
    knobs = np.stack(np.meshgrid([0, 1], [0, 1e-3, 1], [0, 1]), -1).reshape(-1, 1, 1, 3).astype(dtype)
    metallic, roughness, specular = np.moveaxis(knobs, -1, 0)
    color = np.array([1.0, 0.5, 0.0], dtype)
    u = sampling.Generator(3).uniform(np.arange(64)[:, None, None], 0, np.arange(3), dtype)
    wi = brdf.metallic_roughness_sample(wo, u, color, metallic, roughness, specular)
    f = brdf.metallic_roughness(wi, wo, color, metallic, roughness, specular)
    pdf = brdf.metallic_roughness_pdf(wi, wo, color, metallic, roughness, specular)
    above = wi[..., 2] > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        weight = f * (wi[..., 2] / pdf)[..., None]
    wrong = (f < 0).any(-1) | ((pdf <= 0) & above) | (above & ~(weight <= 4).all(-1))
    strays = int((~np.isfinite(f)).sum() + (~np.isfinite(pdf)).sum() + (~np.isfinite(wi)).sum())
    return Measurement(int(wrong.sum()), pdf.size, strays)


@extreme(
    "brdf.fresnel_schlick",
    "both ends and beside them",
    domain="cosines 0, subnormal, 1 - ulp, 1; f0 0.04",
    unit="ulp",
    claim=2,
)
def _fresnel(dtype: np.dtype) -> Measurement:
    info = np.finfo(dtype)
    cosines = np.array([0, info.smallest_subnormal, info.tiny, 1e-3, 0.5, 1 - info.eps / 2, 1], dtype)
    f0 = dtype.type(0.04)
    got = brdf.fresnel_schlick(cosines, np.array(f0), np.array(1, dtype))
    error = 0.0
    with mpmath.workdps(50):
        for c, g in zip(cosines, got, strict=True):
            exact = mpmath.mpf(float(f0)) + (1 - mpmath.mpf(float(f0))) * (1 - mpmath.mpf(float(c))) ** 5
            error = max(error, float(abs(mpmath.mpf(float(g)) - exact) / float(np.spacing(dtype.type(float(exact))))))
    return Measurement(error, len(cosines), int((~np.isfinite(got)).sum()))


@extreme("brdf.lambert", "albedo 0 and 1 at grazing", domain="cosines 1 … 1e-7", unit="ulp", claim=1)
def _lambert(dtype: np.dtype) -> Measurement:
    wi, wo = _pairs(dtype)
    got = brdf.lambert(wi, wo, np.array([0, 0.5, 1], dtype)).astype(np.longdouble)
    exact = np.array([0, 0.5, 1], np.longdouble) / np.longdouble("3.14159265358979323846")
    unit = np.spacing(exact.astype(dtype)).astype(np.longdouble)
    error = float((np.abs(got - exact) / unit).max())
    return Measurement(error, len(got), int((~np.isfinite(got)).sum()))
