"""Extremes of Euler angles, quaternions, parts of affine matrices, frames and angles."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import transform
from ..stability import Measurement, extreme
from .transform import _units

_ANY = np.dtype[Any]
_ORDERS = [a + b + c for a in "xyz" for b in "xyz" for c in "xyz" if a != b != c]
_ORDERS += [order.upper() for order in _ORDERS]


def _unit_quaternions(seed: int, n: int, dtype: _ANY) -> NDArray[Any]:
    q = np.random.default_rng(seed).normal(size=(n, 4))
    return np.asarray(q / np.linalg.norm(q, axis=-1, keepdims=True), dtype)


@extreme(
    "transform.euler_angles", "at gimbal lock and beside, all orders", domain="sine 1e-20 .. 1", unit="eps", claim=12
)
def _(dtype: _ANY) -> Measurement:
    rng = np.random.default_rng(10)
    apart = np.concatenate([[0], np.geomspace(1e-20, 1, 49)])
    worst, cases = 0.0, 0
    for order in _ORDERS:
        middle = apart if order[0] == order[2] else np.pi / 2 - apart
        angles = np.stack([rng.uniform(-3, 3, 50), middle * rng.choice([-1, 1], 50), rng.uniform(-3, 3, 50)], -1)
        m = transform.euler(angles, order).astype(dtype)
        again = transform.euler(transform.euler_angles(m, order).astype(np.float64), order)
        worst, cases = max(worst, float(np.abs(again - m).max())), cases + 50
    return _units(worst, dtype, cases)


@extreme(
    "transform.quaternion_slerp", "equal to 1e-30 .. 1 apart: chord", domain="unit, 0 <= t <= 1", unit="eps", claim=2
)
def _(dtype: _ANY) -> Measurement:
    rng = np.random.default_rng(11)
    a = _unit_quaternions(11, 300, np.dtype(np.float64))
    b = a + np.geomspace(1e-30, 1, 300)[:, None] * rng.normal(size=(300, 4))
    b /= np.linalg.norm(b, axis=-1, keepdims=True)
    a, b, t = a.astype(dtype), b.astype(dtype), rng.random(300).astype(dtype)
    wa, wb, wt = (v.astype(np.longdouble) for v in (a, b, t))
    wb *= np.where((wa * wb).sum(-1, keepdims=True) < 0, -1, 1)
    minus, plus = (np.sqrt(((wa + s * wb) ** 2).sum(-1)) for s in (-1, 1))
    angle = 2 * np.arctan2(minus, plus)
    sine = np.where(angle > 0, np.sin(angle), 1)
    exact = np.where(
        (angle > 0)[:, None],
        (np.sin((1 - wt) * angle) / sine)[:, None] * wa + (np.sin(wt * angle) / sine)[:, None] * wb,
        wa,
    )
    return _units(np.abs(transform.quaternion_slerp(a, b, t) - exact).max(-1), dtype, 300)


@extreme(
    "transform.quaternion_slerp", "the long way to opposite ones: length", domain="shortest=False", unit="eps", claim=3
)
def _(dtype: _ANY) -> Measurement:
    rng = np.random.default_rng(12)
    a = _unit_quaternions(12, 300, np.dtype(np.float64))
    b = -a + np.concatenate([np.zeros(10), np.geomspace(1e-30, 1, 290)])[:, None] * rng.normal(size=(300, 4))
    b /= np.linalg.norm(b, axis=-1, keepdims=True)
    got = transform.quaternion_slerp(a.astype(dtype), b.astype(dtype), rng.random(300).astype(dtype), shortest=False)
    return _units(np.abs(np.linalg.norm(got.astype(np.float64), axis=-1) - 1), dtype, 300)


@extreme("transform.quaternion_from_matrix", "angles 0, pi and beside", domain="rotations", unit="eps", claim=2)
def _(dtype: _ANY) -> Measurement:
    rng = np.random.default_rng(13)
    angle = np.concatenate([[0, np.pi], np.geomspace(1e-20, 1, 199), np.pi - np.geomspace(1e-16, 1, 199)])
    axis = rng.normal(size=(400, 3)) * rng.integers(0, 2, (400, 3))
    axis[~axis.any(-1)] = [0, 0, 1]
    q = transform.quaternion_from_axis(axis, angle)
    got = transform.quaternion_from_matrix(transform.quaternion_to_matrix(q).astype(dtype)).astype(np.float64)
    same = np.where((got * q).sum(-1, keepdims=True) < 0, -1, 1)
    return _units(np.abs(got * same - q).max(-1), dtype, 400)


@extreme(
    "transform.quaternion_rotate", "lengths of 1e-30 .. 1e30: by length of v", domain="q != 0", unit="eps", claim=5
)
def _(dtype: _ANY) -> Measurement:
    q = (_unit_quaternions(14, 400, np.dtype(np.float64)) * np.geomspace(1e-30, 1e30, 400)[:, None]).astype(dtype)
    v = np.random.default_rng(14).normal(size=(400, 3)).astype(dtype)
    wide, u = q.astype(np.longdouble), v.astype(np.longdouble)
    wide /= np.sqrt((wide**2).sum(-1, keepdims=True))
    t = 2 * np.cross(wide[:, :3], u)
    exact = u + wide[:, 3:] * t + np.cross(wide[:, :3], t)
    error = np.abs(transform.quaternion_rotate(q, v) - exact).max(-1) / np.sqrt((u**2).sum(-1))
    return _units(error, dtype, 400)


@extreme("transform.decompose", "singular, sheared by 1e9, sized 1e-9 .. 1e9", domain="affine", unit="eps", claim=8)
def _(dtype: _ANY) -> Measurement:
    rng = np.random.default_rng(15)
    linear = rng.normal(size=(600, 3, 3)) * 10.0 ** rng.uniform(-9, 9, (600, 1, 3))
    linear[:100, :, 1] = 3 * linear[:100, :, 0]
    linear[100:200, :, 2] = linear[100:200, :, 0] - linear[100:200, :, 1]
    linear[200:250, :, :] = linear[200:250, :, :1] * rng.normal(size=(50, 1, 3))
    linear[250:300, :, 0] = 0
    linear[300:350] = 0
    linear[350:400, :, 1] = linear[350:400, :, 0] + 1e-5 * linear[350:400, :, 1]
    m = np.zeros((600, 4, 4), dtype)
    m[:, :3, :3], m[:, 3, 3] = linear, 1
    parts = transform.decompose(m)
    again = transform.compose(*(np.asarray(p, np.float64) for p in parts[:4]))[:, :3, :3]
    exact = m[:, :3, :3].astype(np.float64)
    length = np.linalg.norm(exact, axis=1, keepdims=True)
    return _units(np.abs(again - exact) / np.where(length > 0, length, 1), dtype, 600)


@extreme("transform.change_of_basis", "axes of 1e-15 .. 1e15: x volume", domain="volume > 1e-3", unit="eps", claim=3)
def _(dtype: _ANY) -> Measurement:
    rng = np.random.default_rng(16)
    axes = rng.normal(size=(400, 3, 3))
    axes *= 10.0 ** rng.uniform(-15, 15, (400, 3, 1))
    axes = axes.astype(dtype)
    x, y, z = (axes[:, i] for i in range(3))
    length = np.linalg.norm(axes.astype(np.float64), axis=-1)
    unit = axes / length[..., None]
    volume = np.abs(np.linalg.det(unit))
    keep = volume > 1e-3
    m = transform.change_of_basis(x, y, z)[:, :3, :3].astype(np.float64) * length[:, :, None]
    error = np.abs(np.einsum("nij,nkj->nik", m, unit) - np.eye(3)).max((1, 2)) * volume
    return _units(error[keep], dtype, int(keep.sum()))


@extreme("transform.orthonormal_basis", "poles, equator, z = -1: orthonormal", domain="n != 0", unit="eps", claim=3)
def _(dtype: _ANY) -> Measurement:
    n = np.random.default_rng(17).normal(size=(2000, 3))
    n[:900, :2] *= np.geomspace(1e-30, 1, 900)[:, None]
    n[900:1800, 2] *= np.geomspace(1e-30, 1, 900)
    n[:2] = [[0, 0, -1], [0, 0, 1]]
    b = transform.orthonormal_basis(n.astype(dtype)).astype(np.float64)
    return _units(np.abs(b.swapaxes(-1, -2) @ b - np.eye(3)).max((1, 2)), dtype, 2000)


@extreme(
    "transform.angle_between", "angles down to one rounding, and pi minus", domain="all", unit="relative eps", claim=3
)
def _(dtype: _ANY) -> Measurement:
    import mpmath

    rng = np.random.default_rng(18)
    least = float(np.finfo(dtype).eps)
    a = rng.normal(size=(200, 3))
    b = (a + rng.normal(size=(200, 3)) * np.geomspace(least, 1, 200)[:, None]) * rng.choice([-1, 1], (200, 1))
    a, b = a.astype(dtype), (b * np.geomspace(1e-9, 1e9, 200)[:, None]).astype(dtype)
    exact = []
    with mpmath.workprec(250):
        for u, v in zip(a.tolist(), b.tolist(), strict=True):
            u, v = [mpmath.mpf(x) for x in u], [mpmath.mpf(x) for x in v]
            cross = [u[i - 2] * v[i - 1] - u[i - 1] * v[i - 2] for i in range(3)]
            dot = sum(x * y for x, y in zip(u, v, strict=True))
            exact.append(np.longdouble(str(mpmath.atan2(mpmath.sqrt(sum(c * c for c in cross)), dot))))
    error = np.abs(transform.angle_between(a, b) - np.array(exact))
    return _units(np.where(error > 0, error / np.array(exact), 0), dtype, 200)


@extreme(
    "transform.depth_precision",
    "near/far 1e-6 .. 1e6, all: log2 of step",
    domain="step < distance",
    unit="absolute",
    claim={"float32": 1e-6, "float64": 1e-11},
)
def _(dtype: _ANY) -> Measurement:
    # Against the distances of neighbouring stored depths, in long double.
    near, far = dtype.type(1e-3), dtype.type(1e3)
    z = np.geomspace(2e-3, 900, 400).astype(dtype)
    n, f, w = np.longdouble(near), np.longdouble(far), z.astype(np.longdouble)
    worst = 0.0
    for storage, steps in (("unorm16", 2**16 - 1), ("unorm24", 2**24 - 1)):
        stored = f * (w - n) / ((f - n) * w) + np.longdouble(1) / steps
        after = n * f / (f - stored * (f - n))
        step = np.where((after > w) & (after < 2 * w), after - w, np.nan)
        for depth in ("standard", "zero_to_one", "reversed"):
            got = transform.depth_precision(z, near, far, depth=depth, storage=storage).step  # type: ignore[arg-type]
            worst = max(worst, float(np.nanmax(np.abs(np.log2(got / step)))))
    return Measurement(worst, 2400)
