"""Linearly transformed cosines: light from polygons by rough mirrors, without samples."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import light as _kernels
from .kinds import DiskLight, PolygonLight, RectLight, SphereLight, _table

__all__ = ["Ltc", "LtcTable", "fit_ltc", "ltc"]


@dataclass(frozen=True, eq=False)
class LtcTable:
    """Lobes of GGX as linearly transformed cosines, over roughness and angle.

    Parameters
    ----------
    inverse : ndarray, shape (R, A, 2, 3, 3)
        Matrices that turn each of two lobes back into a cosine lobe: rows of roughness √alpha evenly in [0, 1], columns
        of √(1 − cos θ) evenly in [0, 1]. The eye lies in the plane of x and z; the middle entry is one.
    magnitude : ndarray, shape (R, A, 2)
        What of ∫ f cos θ dω without Fresnel each lobe has above the horizon; their sum is the integral.
    grazing : ndarray, shape (R, A, 2)
        The same, weighed by (1 − wi·h)⁵.
    distance : ndarray, shape (R, A)
        What the fit left: ∫ (f − g)² / (f + g) dω of the lobe and its approximation as densities, at most 2; NaN
        where it is not known.

    Examples
    --------
    >>> table = fit_ltc((3, 4), steps=4)
    >>> table.inverse.shape, bool(0.3 < table.magnitude[-1, 0].sum() < 0.32)
    ((3, 4, 2, 3, 3), True)
    """

    inverse: NDArray[np.float32]
    magnitude: NDArray[np.float32]
    grazing: NDArray[np.float32]
    distance: NDArray[np.float64]

    def __post_init__(self) -> None:
        shape = np.shape(self.magnitude)[:2]
        if len(shape) != 2 or min(shape) < 2:
            raise ValueError(f"magnitude: expected shape (R, A, 2) of two rows and columns at least, got {shape}")
        for name, more in (("inverse", (2, 3, 3)), ("magnitude", (2,)), ("grazing", (2,))):
            value = _arrays.floats(name, getattr(self, name), np.float32)
            if value.shape != shape + more or not np.isfinite(value).all():
                raise ValueError(f"{name}: expected shape {shape + more} of finite numbers, got {value.shape}")
            object.__setattr__(self, name, value)
        distance = _arrays.floats("distance", self.distance, np.float64)
        if distance.shape != shape:
            raise ValueError(f"distance: expected shape {shape}, got {distance.shape}")
        object.__setattr__(self, "distance", distance)

    @classmethod
    def _of(cls, lobes: NDArray[np.float32], distance: NDArray[np.float64]) -> LtcTable:
        rows, angles = distance.shape
        matrices, magnitude, grazing = np.split(lobes.reshape(rows, angles, 12), [8, 10], -1)
        xx, xz, zx, zz = np.moveaxis(matrices.reshape(rows, angles, 2, 4), -1, 0)
        alpha = _alphas(rows)
        inverse = np.zeros((rows, angles, 2, 3, 3), np.float32)
        inverse[..., 0, 0], inverse[..., 0, 2], inverse[..., 1, 1] = xx, xz, 1
        inverse[..., 2, 0], inverse[..., 2, 2] = zx * alpha, zz * alpha
        return cls(inverse, magnitude.copy(), grazing.copy(), distance)

    def _lobes(self) -> tuple[NDArray[np.float32], int]:
        rows, angles, _ = self.magnitude.shape
        m, alpha = self.inverse, _alphas(rows)
        matrices = np.stack((m[..., 0, 0], m[..., 0, 2], m[..., 2, 0] / alpha, m[..., 2, 2] / alpha), -1)
        numbers = np.concatenate([matrices.reshape(rows, angles, 8), self.magnitude, self.grazing], -1)
        return np.ascontiguousarray(numbers.reshape(-1, 12), np.float32), angles

    @classmethod
    def shipped(cls) -> LtcTable:
        """The table that `ltc` uses: ``fit_ltc()`` as it was run.

        Returns
        -------
        LtcTable
        """
        lobes = _kernels.ltc_shipped()
        return cls._of(lobes, np.full((32, 32), np.nan))


def _alphas(rows: int) -> NDArray[np.float32]:
    return np.maximum(np.linspace(0, 1, rows) ** 2, 1e-4).astype(np.float32)[:, None, None]


def fit_ltc(
    size: tuple[int, int] = (32, 32),
    *,
    steps: int = 24,
    progress: bool | Callable[[int, int], object] | None = None,
) -> LtcTable:
    """Fit linearly transformed cosines to GGX with height-correlated Smith masking.

    Parameters
    ----------
    size : (rows, columns)
        Of roughness and of angle, each at least 2.
    steps : int
        Three times its square are the directions at which lobes are compared.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Returns
    -------
    LtcTable

    Raises
    ------
    TypeError, ValueError
        If a number is not an integer of its domain.

    Notes
    -----
    GGX is fitted by the sum of two lobes, a narrow one and a wide one, by Levenberg's and Marquardt's steps over all
    four degrees of freedom of each, both with half of the light. Each pair starts from its neighbour in the table,
    so that what lies between them can be interpolated. The same bits whatever the number of threads. ``fit_ltc()``
    gives the shipped table.

    References
    ----------
    E. Heitz, J. Dupuy, S. Hill, D. Neubelt, *Real-time polygonal-light shading with linearly transformed cosines*,
    2016.
    D. W. Marquardt, *An algorithm for least-squares estimation of nonlinear parameters*, 1963.

    Examples
    --------
    >>> bool((fit_ltc((2, 2), steps=4).distance < 0.5).all())
    True
    """
    rows, angles = _arrays.counts("size", size, 2, 2, 1024)
    steps = _arrays.count("steps", steps, 2, 256)
    call = _arrays.progress_callback(progress, "fit_ltc")
    lobes, distance = _kernels.ltc_fit(rows, angles, steps, call)
    return LtcTable._of(lobes, distance.reshape(rows, angles))


class Ltc(NamedTuple):
    """Light from an area light by rough mirrors."""

    radiance: Floats
    """Towards the eye, (..., 3)."""
    base: Floats
    """The part that F0 weighs, of unit radiance, (...)."""
    edge: Floats
    """The part that F90 − F0 weighs, of unit radiance, (...)."""


def ltc(
    light: RectLight | PolygonLight | DiskLight | SphereLight,
    points: ArrayLike,
    normals: ArrayLike,
    wo: ArrayLike,
    alpha: ArrayLike,
    f0: ArrayLike = 1.0,
    f90: ArrayLike = 1.0,
    *,
    table: LtcTable | None = None,
    full_output: bool = False,
) -> Any:
    """The radiance that rough mirrors (GGX) reflect from an area light, by linearly transformed cosines.

    Parameters
    ----------
    light : RectLight, PolygonLight, DiskLight or SphereLight
    points, normals, wo : array_like, shape (..., 3)
        Where it is reflected, unit normals, and unit directions to the eye.
    alpha : array_like, shape (...)
        Width of the microfacets' distribution in (0, 1], roughness².
    f0, f90 : array_like, shape (...) or (..., 3)
        Schlick's reflectance at normal incidence and at grazing; a last axis of three is one of colours.
    table : LtcTable, optional
        Of `fit_ltc`; None: the one that is shipped.
    full_output : bool
        Give `Ltc`: the two parts as well.

    Returns
    -------
    ndarray, shape (..., 3), or Ltc
        W/(m² sr) towards the eye; zero seen from below, NaN where alpha is out of its domain.

    Raises
    ------
    TypeError, ValueError
        If `light` has no outline, or an argument is not real or of the wrong shape.

    Notes
    -----
    Polygons are clipped exactly at the surface's horizon, then at that of the lobe. Disks, and spheres by their rims,
    are polygons of 24 corners with the same area. A diffuse lobe is `polygon_irradiance` over π, exact. The error is
    that of the family of lobes: half of the integral of the difference of both as densities is 0.002 to 0.012 seen
    from above, 0.01 to 0.03 at 60 degrees, 0.03 to 0.16 at 85 degrees, for roughness 0.25 to 1; of the light of a
    rectangle near a floor 0.15 % of the brightest at roughness 0.25, 0.6 % at 0.5 and 0.8 (root mean square; a single
    lobe, as first published, has 0.2 %, 1.6 % and 1.4 %). A light all around gives the lobe's whole magnitude.
    Mirrors of roughness below 0.03 seen from less than two degrees above have a lobe that is not theirs. A
    quadrilateral above the horizons of surface and lobes takes about 0.2 µs a point and thread. Computed in double
    whatever the precision. It takes Fresnel's weight and the lobe's shape apart, and knows no shadow.

    References
    ----------
    E. Heitz, J. Dupuy, S. Hill, D. Neubelt, *Real-time polygonal-light shading with linearly transformed cosines*,
    2016.
    S. Hill, E. Heitz, *LTC Fresnel approximation*, 2016.

    Examples
    --------
    >>> light = RectLight((0, 2, 0), (4, 0, 0), (0, 0, 4), (1, 1, 1))
    >>> up = [0.0, 1.0, 0.0]
    >>> bool(ltc(light, [0.0, 0, 0], up, up, 0.01)[0] > 0.99)
    True
    """
    full_output = _arrays.flag("full_output", full_output)
    if not isinstance(light, RectLight | PolygonLight | DiskLight | SphereLight):
        raise TypeError(f"light: expected a light with an outline, got {type(light).__name__}")
    dtype = _arrays.result_dtype(points=points, normals=normals, wo=wo)
    vectors = {"points": points, "normals": normals, "wo": wo}
    core = {n: (_arrays.vectors(n, v, 3, dtype), 1) for n, v in vectors.items()}
    core["alpha"] = (_arrays.floats("alpha", alpha, dtype), 0)
    shape, flat = _arrays.broadcast(core)
    parts = np.empty((len(flat[0]), 5), dtype)
    if table is not None and not isinstance(table, LtcTable):
        raise TypeError(f"table: expected an LtcTable, got {type(table).__name__}")
    own = None if table is None else table._lobes()
    _kernels.ltc_light(_table("light", light), own, flat, parts)
    base, edge = (np.ascontiguousarray(p).reshape(shape) for p in parts.T[:2])
    low, high = (_colors(n, v, dtype) for n, v in (("f0", f0), ("f90", f90)))
    with np.errstate(invalid="ignore", over="ignore"):
        # Reflectances that are no numbers give none.
        radiance = (low * base[..., None] + (high - low) * edge[..., None]) * parts[:, 2:].reshape(*shape, 3)
    return Ltc(radiance, base, edge) if full_output else radiance


def _colors(name: str, value: ArrayLike, dtype: np.dtype[Any]) -> Floats:
    array = _arrays.floats(name, value, dtype)
    return array if array.ndim and array.shape[-1] == 3 else array[..., None]
