"""Extremes of warps of directions, of tables of weights and of weights of techniques."""

from __future__ import annotations

from collections.abc import Callable

import mpmath
import numpy as np

from ... import sampling
from ..._arrays import Floats
from ..stability import Measurement, extreme

_ANGLES = (1e-15, 1e-8, 1e-4, 0.5, 1.5707963, 2.5, 3.14159)


def _ends(dtype: np.dtype) -> Floats:
    """Every pair of the numbers at which a warp might slip."""
    one = dtype.type(1)
    edge = [0, np.finfo(dtype).smallest_subnormal, 2.0**-24, 0.25, 0.5, 0.75, np.nextafter(one, dtype.type(0)), one]
    return np.stack(np.meshgrid(np.array(edge, dtype), np.array(edge, dtype)), -1).reshape(-1, 2)


def _triangle(size: float, dtype: np.dtype) -> Floats:
    a = np.array([0.3, -0.2, 0.9])
    return np.array([a, a + size * np.array([1, 0.2, 0.1]), a + size * np.array([-0.3, 1, 0.4])]).astype(dtype)


def _rectangle(center: tuple[float, ...], width: float, height: float, dtype: np.dtype) -> list[Floats]:
    return [np.array(v, dtype) for v in (center, (width, 0, 0), (0, height, 0))]


_RECTANGLES = (
    ((0, 0, 1), 1e-6, 1e-6),
    ((0, 0, 1), 1e4, 1e4),
    ((0, 0, 1), 1e4, 1e-4),
    ((1e3, 1e3, 1), 1, 1),
    ((2, 0.5, 1e-4), 1, 2),
    ((0.2, 0.1, 1e-4), 20, 30),
    ((0, 0, 1e6), 1, 1),
)


@extreme(
    "sampling.square_to_cone",
    "ends of the square, thin and wide cones",
    domain="angles of 1e-15 … 3.14159",
    unit="relative",
    claim={"float32": 2.4e-7, "float64": 5e-16},
)
def _cones(dtype: np.dtype) -> Measurement:
    u, error, strays, cases = _ends(dtype), 0.0, 0, 0
    with mpmath.workdps(60):
        for angle in _ANGLES:
            d = sampling.square_to_cone(u, angle, "polar").astype(np.float64)
            exact_angle = mpmath.mpf(float(dtype.type(angle)))
            width = mpmath.sin(min(exact_angle, mpmath.pi / 2))
            for (a, b), got in zip(u.astype(np.float64), d, strict=True):
                depth = mpmath.mpf(a) * 2 * mpmath.sin(exact_angle / 2) ** 2
                r, turn = mpmath.sqrt(depth * (2 - depth)), 2 * mpmath.pi * mpmath.mpf(b)
                off = mpmath.hypot(got[0] - r * mpmath.cos(turn), got[1] - r * mpmath.sin(turn))
                # x and y beside the cone's width, z beside 1.
                error = max(error, float(off / width), float(abs(got[2] - (1 - depth))))
            strays += int((~np.isfinite(d)).sum())
            cases += len(u)
    return Measurement(error, cases, strays)


@extreme(
    "sampling.square_to_spherical_triangle",
    "solid angles of small triangles",
    domain="angular sizes of 1e-12 (float32: 1e-5) … 1",
    unit="relative",
    claim={"float32": 3e-7, "float64": 1e-15},
)
def _triangles(dtype: np.dtype) -> Measurement:
    error, strays, cases = 0.0, 0, 0
    for size in (1e-12, 1e-9, 1e-5, 1e-2, 1.0):
        if size < 50 * np.finfo(dtype).eps:
            continue
        corners = _triangle(size, dtype)
        found = sampling.square_to_spherical_triangle(_ends(dtype), *corners, full_output=True)
        with mpmath.workdps(60):
            a, b, c = ([mpmath.mpf(float(x)) for x in v] for v in corners)
            la, lb, lc = (mpmath.sqrt(mpmath.fsum(x * x for x in v)) for v in (a, b, c))
            volume = mpmath.det(mpmath.matrix([a, b, c]))
            ab, bc, ca = (mpmath.fdot(p, q) for p, q in ((a, b), (b, c), (c, a)))
            exact = 2 * mpmath.atan2(abs(volume), la * lb * lc + ab * lc + bc * la + ca * lb)
            error = max(error, float(abs(mpmath.mpf(float(found.solid_angle[0])) / exact - 1)))
        strays += int((~np.isfinite(found.direction)).sum())
        strays += int((sampling.square_to_spherical_triangle_pdf(found.direction, *corners) <= 0).sum())
        cases += len(found.direction)
    return Measurement(error, cases, strays)


@extreme(
    "sampling.square_to_spherical_rectangle",
    "solid angles, and the ends of the square",
    domain="1e-6 … 1e4 distances wide, 1e-4 above the plane, 1e6 away",
    unit="relative",
    claim={"float32": 2.4e-7, "float64": 5e-16},
)
def _rectangles(dtype: np.dtype) -> Measurement:
    error, strays, cases = 0.0, 0, 0
    for center, width, height in _RECTANGLES:
        given = _rectangle(center, width, height, dtype)
        found = sampling.square_to_spherical_rectangle(_ends(dtype), *given, full_output=True)
        with mpmath.workdps(60):
            x, y, d = (mpmath.mpf(float(v)) for v in given[0])
            w, h = mpmath.mpf(float(given[1][0])) / 2, mpmath.mpf(float(given[2][1])) / 2
            exact = mpmath.fsum(
                i * j * mpmath.asin((x + i * w) * (y + j * h) / mpmath.hypot(x + i * w, d) / mpmath.hypot(y + j * h, d))
                for i in (-1, 1)
                for j in (-1, 1)
            )
            error = max(error, float(abs(mpmath.mpf(float(found.solid_angle[0])) / exact - 1)))
        strays += int((~np.isfinite(found.direction)).sum())
        strays += int((sampling.square_to_spherical_rectangle_pdf(found.direction, *given) <= 0).sum())
        cases += len(found.direction)
    return Measurement(error, cases, strays)


_HORIZON: dict[str, Callable[[Floats], Floats]] = {
    "square_to_hemisphere": sampling.square_to_hemisphere,
    "square_to_cosine_hemisphere": sampling.square_to_cosine_hemisphere,
}


def _above(warp: Callable[[Floats], Floats]) -> Callable[[np.dtype], Measurement]:
    def measure(dtype: np.dtype) -> Measurement:
        d = warp(_ends(dtype))
        return Measurement(int((d[:, 2] < 0).sum()), len(d), int((~np.isfinite(d)).sum()))

    return measure


for _name, _warp in _HORIZON.items():
    extreme(f"sampling.{_name}", "none below the horizon", domain="pairs of 0 … 1 with ulps", unit="count", claim=0)(
        _above(_warp)
    )


@extreme(
    "sampling.Tabulated2D",
    "rows of zeros, one spike, 1e-30 beside 1e30",
    domain="u at the ends and 4096 others",
    unit="count",
    claim=0,
)
def _tables(dtype: np.dtype) -> Measurement:
    big = 1e30
    pictures = [np.zeros((5, 7)), np.zeros((5, 7)), np.full((5, 7), 1 / big), np.ones((1, 1)), np.zeros((3, 2000))]
    pictures[0][2, 3] = big
    pictures[1][4, 6] = 1 / big
    pictures[2][1] = 0
    pictures[2][3, 2] = big
    pictures[4][1, ::3] = np.geomspace(1e-30, 1e30, 667)
    u = np.concatenate([_ends(dtype), sampling.Generator(1).uniform(np.arange(4096)[:, None], 0, [0, 1], dtype)])
    wrong = strays = 0
    for picture in pictures:
        weights = picture.astype(dtype)
        table = sampling.Tabulated2D(weights)
        drawn = table.sample(u)
        wrong += int((weights[drawn.cell[:, 1], drawn.cell[:, 0]] <= 0).sum())
        wrong += int(((drawn.point < 0) | (drawn.point >= 1)).sum()) + int((table.pdf(drawn.point) <= 0).sum())
        strays += int((~np.isfinite(drawn.pdf)).sum())
    return Measurement(wrong, len(u) * len(pictures), strays)


@extreme(
    "sampling.alias_table",
    "1e-30 beside 1e30, and one spike among zeros",
    domain="probabilities against exact shares",
    unit="absolute",
    claim={"float32": 3e-8, "float64": 5e-16},
)
def _aliases(dtype: np.dtype) -> Measurement:
    error, cases = 0.0, 0
    for weights in ([1e-30, 1e30, 0, 1e30, 1], [0, 0, 1e-30, 0], list(np.geomspace(1e-30, 1e30, 500))):
        w = np.array(weights, dtype)
        table = sampling.alias_table(w)
        exact = w.astype(np.longdouble) / w.astype(np.longdouble).sum()
        error = max(error, float(np.abs(table.probability - exact).max()))
        error = max(error, float(table.probability[w == 0].max(initial=0)))
        cases += len(w)
    return Measurement(error, cases)


@extreme(
    "sampling.power_heuristic",
    "densities from 0 to infinity",
    domain="pairs of 0, tiny, 1, largest, infinite",
    unit="absolute",
    claim={"float32": 1.2e-7, "float64": 2.3e-16},
)
def _weights(dtype: np.dtype) -> Measurement:
    f = np.finfo(dtype)
    edge = np.array([0, f.smallest_subnormal, f.tiny, 1, 3, f.max, np.inf], dtype)
    pairs = np.stack(np.meshgrid(edge, edge), -1).reshape(-1, 2)
    error, strays = 0.0, 0
    for w in (sampling.balance_heuristic(pairs), sampling.power_heuristic(pairs)):
        reached = (pairs > 0).any(-1)
        error = max(error, float(np.abs(w.sum(-1)[reached] - 1).max()), float(np.abs(w[~reached]).max()))
        strays += int((~np.isfinite(w)).sum())
    return Measurement(error, 2 * len(pairs), strays)
