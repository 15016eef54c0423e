"""Extremes of deferred shading: lights at hand and far away, grazing eyes, sizes, parameters at their ends."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ... import brdf, renderer
from ...light import DirectionalLight, DiskLight, PointLight, PolygonLight, RectLight, SphereLight, SpotLight
from ..stability import Measurement, extreme

_METHODS = ("sampling", "ltc", "representative_point", "point")


def _models() -> Iterator[Any]:
    for roughness in (0.0, 1.0):
        yield brdf.MetallicRoughness(1.0, 1.0, roughness, compensation="kulla_conty")
        yield brdf.MetallicRoughness(1.0, 0.0, roughness)
    for eta in (1.0, 1 + 1e-7, 1e3):
        yield brdf.Plastic(1.0, eta, nonlinear=True)
    yield from (brdf.Diffuse(1.0), brdf.OrenNayar(1.0, 1.0), brdf.RoughConductor(1e-4), brdf.RoughConductor(1.0))
    yield from (brdf.Phong(0.5, 0.5, 1e9), brdf.BlinnPhong(0.5, 0.5, 1e9))
    yield from (brdf.RoughDielectric(1e-3), brdf.Principled(1.0, roughness=0.0, clearcoat=1.0, sheen=1.0))


def _grazing(dtype: np.dtype) -> tuple[Any, Any, Any]:
    """Points at the origin, normals up, and eyes from above to 1e-7 over the surface."""
    cosines = np.array([1.0, 0.5, 1e-2, 1e-4, 1e-7])
    turns = np.array([0.0, 1.0, np.pi])
    sine = np.sqrt((1 - cosines) * (1 + cosines))[:, None]
    x, z = sine * np.cos(turns), sine * np.sin(turns)
    wo = np.stack([x, np.broadcast_to(cosines[:, None], x.shape), z], -1).reshape(-1, 3).astype(dtype)
    return np.zeros_like(wo), np.broadcast_to(np.array([0, 1, 0], dtype), wo.shape), wo


@extreme(
    "renderer.shade",
    "lights at hand, far away and in the surface's plane",
    domain="every method and light at 1e-170 … 1e15, with normals up and eyes to 1e-7; not finite or negative",
    unit="count",
    claim=0,
)
def _places(dtype: np.dtype) -> Measurement:
    points, normals, wo = _grazing(dtype)
    wrong, cases = 0, 0
    for away in (0.0, 1e-170, 1e-30, 1e-10, 1.0, 1e6, 1e12):
        lamps: list[Any] = [PointLight((0, away, 0)), PointLight((away, 0, 0)), SpotLight((0, away, 0), (0, -1, 0))]
        lamps += [SphereLight((0, away, 0), 0.5), DiskLight((0, away, 0), (0, -1, 0), 0.5)]
        lamps += [RectLight((0, away, 0), (1, 0, 0), (0, 0, 1)), RectLight((away, 0, 0), (0, 1, 0), (0, 0, 1))]
        lamps += [RectLight((0, away, 0), (1, 0, 0), (0, 0, 1), texture=np.eye(3))]
        lamps += [PolygonLight([[-1, away, -1], [1, away, -1], [0, away, 1]], two_sided=True)]
        for lamp in lamps:
            for method in _METHODS:
                got = renderer.shade(points, normals, brdf.MetallicRoughness(), lamp, wo=wo, method=method, samples=4)
                wrong, cases = wrong + int((~(np.isfinite(got) & (got >= 0))).sum()), cases + got.size
    return Measurement(wrong, cases, 0)


@extreme(
    "renderer.shade",
    "models at the ends of their parameters",
    domain="every method, a rectangle, a sun and a point of light, eyes to 1e-7; not finite or negative",
    unit="count",
    claim=0,
)
def _parameters(dtype: np.dtype) -> Measurement:
    points, normals, wo = _grazing(dtype)
    lamps: list[Any] = [RectLight((0.2, 1, 0), (1, 0, 0), (0, 0, 1))]
    lamps += [DirectionalLight((0.3, -1, 0)), PointLight((1, 1e-3, 0))]
    wrong, cases = 0, 0
    for model in _models():
        for method in _METHODS:
            got = renderer.shade(points, normals, model, lamps, wo=wo, method=method, samples=4)
            wrong, cases = wrong + int((~(np.isfinite(got) & (got >= 0))).sum()), cases + got.size
    return Measurement(wrong, cases, 0)


@extreme(
    "renderer.shade",
    "an element out of its domain",
    domain="NaN, infinity, zero normals, shares of 2 and -1 in one of 24 points; others that are not as before",
    unit="count",
    claim=0,
)
def _contained(dtype: np.dtype) -> Measurement:
    rng = np.random.default_rng(1)
    given: dict[str, Any] = {"points": rng.uniform(-1, 1, (24, 3)).astype(dtype)}
    given["normals"] = np.broadcast_to(np.array([0, 1, 0], dtype), (24, 3)).copy()
    given["wo"], given["geometric_normals"] = given["normals"].copy(), given["normals"].copy()
    given["colors"] = np.ones((24, 3), dtype)
    lamps: list[Any] = [PointLight((0, 3, 0)), RectLight((0.2, 3, 0), (1, 0, 0), (0, 0, 1))]
    lit = [np.ones(24, dtype), np.ones(24, dtype)]
    model, wrong, cases = brdf.MetallicRoughness(), 0, 0

    def shaded() -> Any:
        return renderer.shade(materials=model, lights=lamps, lit=lit, **given)

    whole = shaded()
    for array, bad in [
        *((a, np.nan) for a in (*given.values(), *lit)),
        *((given[n], np.inf) for n in ("points", "colors")),
        *((x, y) for x in (*lit, given["colors"]) for y in (2.0, -1.0)),
        (given["geometric_normals"], 0.0),
    ]:
        kept = array[7].copy()
        array[7] = bad
        got = shaded()
        array[7] = kept
        others = np.delete(got, 7, 0) != np.delete(whole, 7, 0)
        wrong, cases = wrong + int(others.sum()) + int(np.isfinite(got[7]).any()), cases + got.size
    return Measurement(wrong, cases, 0)
