"""What surfaces reflect from lights, nothing in between."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import light as _kernels
from .kinds import DirectionalLight, Light, _table  # noqa: F401

__all__ = ["unshadowed"]


class Receivers(NamedTuple):
    """Oriented points with materials, as the kernels take them."""

    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    arrays: tuple[Floats, ...]
    is_eye: bool
    material_ids: NDArray[np.int32] | None


def _receivers(
    points: ArrayLike,
    normals: ArrayLike,
    wo: ArrayLike | None,
    eye: ArrayLike | None,
    materials: tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike],
    material_ids: ArrayLike | None,
    dtype: np.dtype[Any] | None = None,
) -> Receivers:
    """Checks and flattens what `unshadowed` and its like take, in `dtype` (else that of points and normals)."""
    if (wo is None) == (eye is None):
        raise ValueError("wo: expected either wo or eye, got " + ("neither" if wo is None else "both"))
    dtype = _arrays.result_dtype(points=points, normals=normals) if dtype is None else dtype
    core = {"points": (_arrays.vectors("points", points, 3, dtype), 1)}
    core["normals"] = (_arrays.vectors("normals", normals, 3, dtype), 1)
    if wo is not None:
        core["wo"] = (_arrays.vectors("wo", wo, 3, dtype), 1)
    shape, flat = _arrays.broadcast(core)
    if eye is not None:
        position = _arrays.vectors("eye", eye, 3, dtype)
        if position.shape != (3,):
            raise ValueError(f"eye: expected shape (3,), got {position.shape}")
        flat.append(position.reshape(1, 3))
    names = ("base_color", "metallic", "roughness", "specular")
    knobs = {n: (_arrays.floats(n, m, dtype), int(n == "base_color")) for n, m in zip(names, materials, strict=True)}
    _arrays.vectors("base_color", knobs["base_color"][0], 3, dtype)
    lead, tables = _arrays.broadcast(knobs)
    ids = None
    if material_ids is not None:
        if len(lead) > 1:
            raise ValueError(f"material_ids: expected materials of shape (m,) or (), got {lead}")
        ids = _arrays.array("material_ids", material_ids)
        if ids.dtype.kind not in "iu":
            raise TypeError(f"material_ids: expected integers, got dtype {ids.dtype}")
        if ids.shape != shape:
            raise ValueError(f"material_ids: expected shape {shape}, got {ids.shape}")
        if ids.size and int(ids.max()) >= len(tables[1]):
            raise ValueError(f"material_ids: index {int(ids.max())} is out of range [-1, {len(tables[1])})")
        if ids.dtype.kind == "i":
            # Before the cast: the least of other integers would come round to a row.
            ids = np.maximum(ids, -1)
        ids = np.require(ids.reshape(-1), np.int32, ["C", "A"])
    elif len(tables[1]) != 1 and lead != shape:
        raise ValueError(f"base_color: expected materials of shape () or {shape}, got {lead}")
    return Receivers(shape, dtype, (*flat, *tables), wo is None, ids)


def unshadowed(
    lights: Light | Sequence[Light],
    points: ArrayLike,
    normals: ArrayLike,
    base_color: ArrayLike,
    metallic: ArrayLike = 0.0,
    roughness: ArrayLike = 0.5,
    specular: ArrayLike = 1.0,
    *,
    wo: ArrayLike | None = None,
    eye: ArrayLike | None = None,
    material_ids: ArrayLike | None = None,
    method: Literal["sampling", "ltc", "representative_point"] = "sampling",
    samples: int = 16,
    seed: int = 0,
    out: Floats | None = None,
    progress: bool | Callable[[int, int], object] | None = None,
) -> Floats:
    """The radiance that surfaces reflect from lights with nothing in between.

    Parameters
    ----------
    lights : light or sequence of lights
        Their sum is returned.
    points, normals : array_like, shape (..., 3)
        Surface points and unit (shading) normals. Their precision governs.
    base_color : array_like, shape (3,), (..., 3) or (m, 3)
        See `shadelab.brdf.metallic_roughness`: one material for all points, one for each, or a table of m.
    metallic, roughness, specular : array_like
        Likewise, without the last axis.
    wo : array_like, shape (..., 3), optional
        Unit directions to the eye. Either this or `eye` is needed.
    eye : array_like, shape (3,), optional
        The eye's position.
    material_ids : array_like of int, shape (...), optional
        Rows of the table; a negative one marks no surface, whose radiance is zero.
    method : {"sampling", "ltc", "representative_point"}
        How the mirrors' part of area lights is found: an average of samples; linearly transformed cosines (see
        `shadelab.light.ltc`), without noise; or one point of the light nearest to the mirror direction, under a wider
        lobe, the cheapest and farthest from the truth.
    samples : int
        Points of each area light and directions of each lobe that the mirrors' part is averaged over; 0 leaves that
        part out.
    seed : int
        Of the samples.
    out : ndarray, optional
        Where to write.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Returns
    -------
    ndarray, shape (..., 3)
        Radiance towards the eye in W/(m² sr), per channel; zero seen from below a surface, NaN where an element is
        out of its domain.

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit, a row is out of the table, or neither or both of `wo` and `eye` are given.

    Notes
    -----
    Punctual lights, and the diffuse part of area lights with its Fresnel factor, are exact. The mirrors' part of a
    rectangle has a relative error of about 6 % at 16 samples, 2 % at 64 and 0.8 % at 256 (root mean square, a
    bright rectangle near, roughness 0.5); it is unbiased. For a rectangle about 0.6 µs a point and thread, and 0.1 µs a
    sample.

    References
    ----------
    J. Arvo, *Applications of irradiance tensors to the simulation of non-Lambertian phenomena*, 1995.
    E. Veach, L. Guibas, *Optimally combining sampling techniques for Monte Carlo rendering*, 1995.
    E. Heitz, J. Dupuy, S. Hill, D. Neubelt, *Real-time polygonal-light shading with linearly transformed cosines*,
    2016.
    B. Karis, *Real shading in Unreal Engine 4*, 2013.

    Examples
    --------
    >>> light = DirectionalLight((0, -1, 0), irradiance=(np.pi,) * 3)
    >>> up = [0.0, 1.0, 0.0]
    >>> unshadowed(light, [0.0, 0.0, 0.0], up, [0.5, 0.25, 0.0], specular=0.0, wo=up)
    array([0.5 , 0.25, 0.  ])
    """
    packed = _table("lights", lights)
    r = _receivers(points, normals, wo, eye, (base_color, metallic, roughness, specular), material_ids)
    draws = _arrays.count("samples", samples, 0, 1 << 20), _arrays.count("seed", seed, 0, 2**64 - 1)
    how = _arrays.choice("method", method, ("sampling", "ltc", "representative_point"))
    out = _arrays.output("out", out, (*r.shape, 3), r.dtype)
    call = _arrays.progress_callback(progress, "unshadowed")
    _kernels.unshadowed(r.arrays, r.is_eye, r.material_ids, packed, how, draws, out.reshape(-1, 3), call)
    return out
