"""Extremes of the models of `brdf`: indices near one, total reflection, metals, ends of widths and angles, energy."""

from __future__ import annotations

import itertools
from typing import Any

import mpmath
import numpy as np

from ... import brdf, sampling
from ..._arrays import Floats
from ..stability import Measurement, extreme


def _exact_fresnel(c: Any, eta: Any, k: Any = 0.0) -> tuple[mpmath.mpf, mpmath.mpf]:
    """Reflectances s and p at the given (rounded) numbers."""
    c, index = mpmath.mpf(float(c)), mpmath.mpc(float(eta), float(k))
    root = mpmath.sqrt(index**2 - (1 - c * c))
    s, p = (c - root) / (c + root), (index**2 * c - root) / (index**2 * c + root)
    return abs(s) ** 2, abs(p) ** 2


def _fresnel(dtype: np.dtype, etas: Any, ks: Any, cosines: Any) -> Measurement:
    unit = float(np.finfo(dtype).eps) / 2
    error, cases, strays = 0.0, 0, 0
    with mpmath.workdps(60):
        for eta, k in zip(etas, ks, strict=True):
            eta, k = dtype.type(eta), None if k is None else dtype.type(k)
            c = np.asarray(cosines, dtype)
            got = brdf.fresnel(c, np.array(eta), None if k is None else np.array(k), full_output=True)
            strays += int((~np.isfinite(got.s)).sum() + (~np.isfinite(got.p)).sum())
            for i in range(len(c)):
                exact = _exact_fresnel(c[i], eta, 0.0 if k is None else k)
                # Of the two together: at Brewster's angle the one is nothing.
                whole = max(exact)
                for mine, true in zip((got.s[i], got.p[i]), exact, strict=True):
                    error = max(error, float(abs(float(mine) - true) / whole) if whole else abs(float(mine)))
                    cases += 1
    return Measurement(error / unit, cases, strays)


_COSINES = (1.0, 0.9, 0.5, 1e-2, 1e-4, 1e-7)


@extreme(
    "brdf.fresnel",
    "indices at and beside one, and their inverses",
    domain="η = 1, 1 ± 1e-3, 1 ± 1e-6, 1.5, 1/1.5, 100; cosines 1 … 1e-7; of the larger polarisation",
    unit="relative",
    claim=16,
)
def _near_one(dtype: np.dtype) -> Measurement:
    etas = (1.0, 1 + 1e-3, 1 - 1e-3, 1 + 1e-6, 1 - 1e-6, 1.5, 1 / 1.5, 100.0)
    return _fresnel(dtype, etas, [None] * len(etas), _COSINES)


@extreme(
    "brdf.fresnel",
    "complex indices",
    domain="η + ik of silver, aluminium, iron, (0.01, 10), (10, 50); cosines 1 … 1e-7",
    unit="relative",
    claim=8,
)
def _metals(dtype: np.dtype) -> Measurement:
    pairs = ((0.05, 4.0), (1.37, 7.6), (2.9, 3.1), (0.01, 10.0), (10.0, 50.0))
    return _fresnel(dtype, [p[0] for p in pairs], [p[1] for p in pairs], _COSINES)


@extreme(
    "brdf.refract",
    "about the critical angle",
    domain="η = 1/1.5 and 1 - 1e-6, cosines within 100 ulp of critical; | |t| - 1 | in rounding units, NaN where total",
    unit="absolute",
    claim=6,
)
def _critical(dtype: np.dtype) -> Measurement:
    info = np.finfo(dtype)
    worst, cases, strays = 0.0, 0, 0
    for eta in (dtype.type(1 / 1.5), dtype.type(1 - 1e-6)):
        critical = np.sqrt(1 - float(eta) ** 2)
        c = (critical + np.arange(-100, 101) * np.spacing(dtype.type(critical))).astype(dtype)
        w = np.stack([np.sqrt(1 - c.astype(float) ** 2), np.zeros(len(c)), c], -1).astype(dtype)
        bent = brdf.refract(w, np.array([0, 0, 1], dtype), eta)
        length = np.sqrt((bent.direction.astype(np.longdouble) ** 2).sum(-1))
        strays += int((np.isnan(length) != bent.total).sum())
        worst = max(worst, float(np.nanmax(np.abs(length - 1))))
        cases += len(c)
    return Measurement(worst / (float(info.eps) / 2), cases, strays)


@extreme(
    "brdf.fresnel_average",
    "from one to large indices",
    domain="η = 1 + 1e-7 … 50, against quadrature in 30 digits",
    unit="absolute",
    claim={"float32": 6e-8, "float64": 1e-10},
)
def _average(dtype: np.dtype) -> Measurement:
    etas = (1.0, 1 + 1e-6, 1 + 1e-4, 1.01, 1.0199, 1.0201, 1.1, 1.5, 5.0, 50.0)
    given = np.array(etas, dtype)
    got = brdf.fresnel_average(given)
    error = 0.0
    with mpmath.workdps(30):
        for eta, mine in zip(given.tolist(), got, strict=True):
            bend = mpmath.sqrt(mpmath.mpf(eta) ** 2 - 1)
            points = sorted({0.0, min(float(bend) * 0.1, 0.5), min(float(bend), 0.8), 1.0})

            def integrand(c: Any, eta: float = eta) -> Any:
                return c * sum(_exact_fresnel(c, eta))

            error = max(error, abs(float(mpmath.quad(integrand, points) - mpmath.mpf(float(mine)))))
    return Measurement(error, len(etas), int((~np.isfinite(got)).sum()))


def _at(cosine: Any, azimuth: Any, dtype: np.dtype) -> Floats:
    cosine, azimuth = np.broadcast_arrays(cosine, azimuth)
    sine = np.sqrt(1 - cosine * cosine)
    return np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine], -1).astype(dtype)


def _models() -> list[brdf.Model]:
    white: dict[str, Any] = {"eta": 1e-9, "k": 1e9}
    models: list[brdf.Model] = [
        brdf.Diffuse(1.0),
        brdf.OrenNayar(1.0, 0.0),
        brdf.OrenNayar(1.0, 1.0),
        brdf.OrenNayar(1.0, 1.0, form="qualitative"),
        brdf.Plastic(1.0, 1.0),
        brdf.Plastic(1.0, 2.5, nonlinear=True),
        brdf.MetallicRoughness((1.0, 1.0, 1.0), 0.0, 0.0),
        brdf.MetallicRoughness((1.0, 1.0, 1.0), 1.0, 1.0),
        brdf.SpecularGlossiness(1.0, 0.5, 0.0),
        brdf.SpecularGlossiness(1.0, 1.0, 1.0),
        brdf.Phong(0.5, 0.5, 0.0),
        brdf.BlinnPhong(0.0, 1.0, 1000.0),
    ]
    for alpha in (1e-4, 1e-2, 1.0):
        models += [
            brdf.RoughConductor(alpha, **white),
            brdf.RoughDielectric(alpha),
            brdf.RoughDielectric(alpha, 1 / 1.5),
        ]
        models.append(brdf.RoughConductor(max(alpha, 1e-2), **white, distribution="beckmann", masking="separable"))
    return models


@extreme(
    "brdf.Model.sample",
    "energy at the ends of parameters and angles",
    domain="all models at albedo 1, cosines 1 … 1e-4; the most flux given back above one, by 4096 draws",
    unit="absolute",
    claim=3e-4,
)
def _energy(dtype: np.dtype) -> Measurement:
    u = np.minimum(sampling.sobol(4096, 3, seed=3), 1 - 1e-7).astype(dtype)
    worst, cases, strays = 0.0, 0, 0
    for model in _models():
        for cosine in (1.0, 0.5, 1e-2, 1e-4):
            draws = model.sample(_at(cosine, 0.3, dtype), u)
            # Flux rather than radiance.
            flux = draws.weight.astype(np.float64) * (draws.eta.astype(np.float64) ** 2)[:, None]
            strays += int((~np.isfinite(flux)).sum() + (flux < 0).sum())
            worst = max(worst, float(flux.mean(0).max()) - 1)
            cases += len(u)
    return Measurement(worst, cases, strays)


@extreme(
    "brdf.Model.eval",
    "reciprocity at the ends of parameters and angles",
    domain="opaque models, cosines 1 … 1e-7, mirrored, equal and across; relative, in rounding units",
    unit="relative",
    claim=4,
)
def _reciprocity(dtype: np.dtype) -> Measurement:
    cosines = np.array([1.0, 0.5, 1e-2, 1e-4, 1e-7])
    turns = np.array([0.0, 1e-3, 1.0, np.pi])
    wi = _at(cosines[:, None, None], turns, dtype)
    wo = _at(cosines[:, None], 0.0, dtype)
    worst, cases, strays = 0.0, 0, 0
    for model in _models():
        if model._transmits:
            continue
        there, back = np.broadcast_arrays(model.eval(wi, wo), model.eval(wo, wi))
        strays += int((~np.isfinite(there)).sum() + (~np.isfinite(back)).sum())
        large = np.maximum(np.abs(there), np.abs(back))
        normal = large > float(np.finfo(dtype).tiny)
        off = np.abs(there.astype(np.longdouble) - back)[normal] / large[normal]
        worst, cases = max(worst, float(off.max(initial=0))), cases + there.size
    return Measurement(worst / (float(np.finfo(dtype).eps) / 2), cases, strays)


@extreme(
    "brdf.RoughDielectric",
    "indices at and beside one",
    domain="η = 1, 1 ± 1e-7, 1 ± 1e-3, 1e±9; alpha 1e-3 … 1, every compensation; values, densities and weights that are"
    " negative or not finite",
    unit="count",
    claim=0,
)
def _thin(dtype: np.dtype) -> Measurement:
    u = sampling.Generator(3).uniform(np.arange(256)[:, None], 0, np.arange(3), dtype)
    wo = np.concatenate([_at(np.array([1.0, 0.5, 1e-3]), 0.3, dtype), _at(np.array([-1.0, -0.5, -1e-3]), 0.3, dtype)])
    wrong, cases = 0, 0
    forms: tuple[Any, ...] = ("none", "kulla_conty", "scaled")
    for eta in (1.0, 1 + 1e-7, 1 - 1e-7, 1 + 1e-3, 1 - 1e-3, 1e9, 1e-9):
        for alpha, form in itertools.product((1e-3, 1e-1, 1.0), forms):
            model = brdf.RoughDielectric(alpha, eta, compensation=form)
            draws = model.sample(wo, u[:, None])
            value, density = model.eval(draws.wi, wo), model.pdf(draws.wi, wo)
            for a in (draws.weight, draws.pdf, value, density):
                wrong += int((~(np.isfinite(a) & (a >= 0))).sum())
                cases += a.size
    return Measurement(wrong, cases)


@extreme(
    "brdf.RoughDielectric",
    "energy with compensation, from smooth to roughest, from nearly equal to very unequal indices",
    domain="η = 1 ± 1e-3, 1.03, 1.5 and its inverse, 1e±3; alpha 1e-4 … 1; both forms; power lost or invented of light"
    " from everywhere on either side, by 4096 draws for 24 cosines",
    unit="absolute",
    claim=2e-3,
)
def _furnace(dtype: np.dtype) -> Measurement:
    u = np.minimum(sampling.sobol(4096, 3, seed=3), 1 - 1e-7).astype(dtype)
    x, weight = np.polynomial.legendre.leggauss(24)
    cosine = (x + 1) / 2
    forms: tuple[Any, ...] = ("kulla_conty", "scaled")
    worst, cases, strays = 0.0, 0, 0
    for eta, alpha in itertools.product((1 - 1e-3, 1 + 1e-3, 1.03, 1.5, 1 / 1.5, 1e3, 1e-3), (1e-4, 1e-2, 0.3, 1.0)):
        for form, side in itertools.product(forms, (1, -1)):
            wo = _at(cosine, 0.3, dtype) * np.array([1, 1, side], dtype)
            draws = brdf.RoughDielectric(alpha, eta, compensation=form).sample(wo[:, None], u)
            flux = draws.weight[..., 0].astype(np.float64) * draws.eta.astype(np.float64) ** 2
            strays += int((~np.isfinite(flux)).sum())
            worst = max(worst, abs(float((flux.mean(1) * weight * cosine).sum()) - 1))
            cases += flux.size
    return Measurement(worst, cases, strays)
