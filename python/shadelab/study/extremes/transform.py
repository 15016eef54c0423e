"""Extremes of views, projections, rotations and normal matrices."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import transform
from ..stability import Measurement, extreme

_ANY = np.dtype[Any]
_DEPTHS: tuple[transform.Depth, ...] = ("standard", "zero_to_one", "reversed")


def _units(error: Any, dtype: _ANY, cases: int) -> Measurement:
    """The largest of absolute errors in rounding units (eps) of the precision; what is not finite is a stray."""
    error = np.asarray(error, np.float64)
    finite = np.isfinite(error)
    return Measurement(float(error[finite].max(initial=0) / np.finfo(dtype).eps), cases, int(error.size - finite.sum()))


def _view(eye: NDArray[Any], target: NDArray[Any], up: NDArray[Any]) -> NDArray[Any]:
    """The rotation of a view in long double."""
    wide = [v.astype(np.longdouble) for v in (eye, target, up)]
    back = wide[0] - wide[1]
    back /= np.sqrt((back**2).sum(-1, keepdims=True))
    right = np.cross(wide[2], back)
    right /= np.sqrt((right**2).sum(-1, keepdims=True))
    return np.stack([right, np.cross(back, right), back], -2)


@extreme("transform.look_at", "up nearly along the sight: error x sine", domain="sine >= 1e-5", unit="eps", claim=2)
def _(dtype: _ANY) -> Measurement:
    rng = np.random.default_rng(1)
    eye, target = rng.normal(size=(2, 400, 3)).astype(dtype)
    across = np.cross(eye - target, rng.normal(size=(400, 3)))
    across /= np.linalg.norm(across, axis=-1, keepdims=True)
    sight = (target - eye) / np.linalg.norm(target - eye, axis=-1, keepdims=True)
    up = (sight + across * np.geomspace(1e-5, 1, 400)[:, None]).astype(dtype)
    exact = _view(eye, target, up)
    wide = np.asarray(up, np.longdouble)
    sine = np.linalg.norm(np.cross(wide / np.linalg.norm(up, axis=-1, keepdims=True), exact[:, 2]), axis=-1)
    error = np.abs(transform.look_at(eye, target, up)[:, :3, :3] - exact).max((1, 2))
    return _units(error * sine, dtype, 400)


@extreme("transform.look_at", "eye and target 1e-15 to 1e15 apart: isometry", domain="all", unit="eps", claim=3)
def _(dtype: _ANY) -> Measurement:
    rng = np.random.default_rng(2)
    scale = np.geomspace(1e-15, 1e15, 300)[:, None]
    m = transform.look_at(
        (rng.normal(size=(300, 3)) * scale).astype(dtype),
        (rng.normal(size=(300, 3)) * scale).astype(dtype),
        rng.normal(size=(300, 3)).astype(dtype),
    )[:, :3, :3].astype(np.float64)
    return _units(np.abs(m @ m.swapaxes(-1, -2) - np.eye(3)).max((1, 2)), dtype, 300)


@extreme("transform.look_at", "no view: NaN in a batch", domain="up parallel, eye = target", unit="count", claim=0)
def _(dtype: _ANY) -> Measurement:
    d = np.random.default_rng(3).normal(size=(200, 3)).astype(dtype)
    along = transform.look_at(d, np.zeros(3, dtype), d * np.geomspace(1e-20, 1e20, 200)[:, None].astype(dtype))
    same = transform.look_at(d, d, np.array([0, 1, 0], dtype))
    return Measurement(float((~np.isnan(along).any((1, 2))).sum() + (~np.isnan(same).any((1, 2))).sum()), 400)


@extreme("transform.rotate_axis", "angles 0, 1e-8, pi and between", domain="|angle| <= 1e4", unit="eps", claim=4)
def _(dtype: _ANY) -> Measurement:
    rng = np.random.default_rng(4)
    angle = np.concatenate(
        [[0, 1e-8, np.pi, -np.pi, np.pi / 2], rng.uniform(-1e4, 1e4, 300), np.geomspace(1e-20, 3, 95)]
    )
    angle = angle.astype(dtype)
    axis = (rng.normal(size=(400, 3)) * np.geomspace(1e-20, 1e20, 400)[:, None]).astype(dtype)
    u = axis.astype(np.longdouble)
    u /= np.sqrt((u**2).sum(-1, keepdims=True))
    a = angle.astype(np.longdouble)[:, None, None]
    zero = np.zeros(400, np.longdouble)
    k = np.stack([zero, -u[:, 2], u[:, 1], u[:, 2], zero, -u[:, 0], -u[:, 1], u[:, 0], zero], -1).reshape(400, 3, 3)
    square = np.einsum("nij,njk->nik", k, k)
    exact = np.eye(3) + np.sin(a) * k + 2 * np.sin(a / 2) ** 2 * square
    return _units(np.abs(transform.rotate_axis(axis, angle)[:, :3, :3] - exact).max((1, 2)), dtype, 400)


@extreme("transform.perspective", "fields of view near 0 and pi", domain="1e-6 .. pi - 1e-3", unit="ulp", claim=3)
def _(dtype: _ANY) -> Measurement:
    import mpmath

    fov = np.concatenate([np.geomspace(1e-6, 1, 100), np.pi - np.geomspace(1e-3, 1, 100)]).astype(dtype)
    m = transform.perspective(fov, dtype.type(1), dtype.type(0.125), dtype.type(64))
    with mpmath.workprec(120):
        exact = np.array([float(mpmath.cot(mpmath.mpf(float(f)) / 2)) for f in fov])
    error = np.abs(m[:, 1, 1] - exact) / np.spacing(exact.astype(dtype)).astype(np.float64)
    return Measurement(float(error.max()), 200, int((~np.isfinite(m)).any((1, 2)).sum()))


@extreme(
    "transform.linear_depth", "near/far 1e-6, all conventions: x near/z", domain="near .. far", unit="eps", claim=2
)
def _(dtype: _ANY) -> Measurement:
    near = 1e-3
    z = np.geomspace(near, 1e3, 500).astype(dtype)
    points = np.stack([0 * z, 0 * z, -z], -1)
    worst = 0.0
    for depth in _DEPTHS:
        m = transform.perspective(1.0, 1.0, near, 1e3, depth=depth)
        got = transform.linear_depth(transform.transform_points(points, m)[:, 2], m).astype(np.float64)
        # An error e in z/w is e z / near of the distance: nothing is left at z = near / eps.
        left = z < 0.1 * near / np.finfo(dtype).eps
        worst = max(worst, float((np.abs(got - z) / z / np.maximum(z / near, 1))[left].max()))
    return _units(worst, dtype, 1500)


@extreme("transform.linear_depth", "reversed, far infinite: relative", domain="near .. 1e12 near", unit="eps", claim=2)
def _(dtype: _ANY) -> Measurement:
    z = np.geomspace(0.1, 1e11, 500).astype(dtype)
    m = transform.perspective(1.0, near=0.1, depth="reversed")
    got = transform.linear_depth(transform.transform_points(np.stack([0 * z, 0 * z, -z], -1), m)[:, 2], m)
    return _units(np.abs(got.astype(np.float64) - z) / z, dtype, 500)


@extreme("transform.normal_matrix", "singular, 1e-30 and 1e30: perpendicular", domain="rank >= 2", unit="eps", claim=2)
def _(dtype: _ANY) -> Measurement:
    rng = np.random.default_rng(5)
    m = np.zeros((300, 4, 4))
    m[:, 3, 3] = 1
    m[:, :3, :2] = rng.normal(size=(300, 3, 2))  # columns of rank two: a plane is left
    m[:, :3, :3] *= np.geomspace(1e-30, 1e30, 300)[:, None, None]
    m = m.astype(dtype)
    n = transform.transform_normals(np.array([0, 0, 1], dtype), m).astype(np.float64)
    columns = m[:, :3, :2].astype(np.float64)
    columns /= np.linalg.norm(columns, axis=1, keepdims=True)
    sine = np.linalg.norm(np.cross(columns[..., 0], columns[..., 1]), axis=-1)
    error = np.abs(np.einsum("ni,nij->nj", n, columns)).max(-1) * sine
    return _units(error, dtype, 300)


@extreme("transform.project", "w -> 0 and below: NaN, else finite", domain="w > 1e-30", unit="count", claim=0)
def _(dtype: _ANY) -> Measurement:
    z = np.concatenate([-np.geomspace(1e-30, 1, 100), np.geomspace(1e-30, 1, 100), [0.0, -0.0]]).astype(dtype)
    got = transform.project(np.stack([0 * z, 0 * z, z], -1), transform.perspective(1.0), (64, 64))
    wrong = np.isfinite(got[:, :2]).all(-1) != (z < 0)
    return Measurement(float(wrong.sum()), z.size)
