"""Deferred shading: the light that the surfaces of a G-buffer send to the eye."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays, brdf
from .._arrays import Floats
from .._kernels import renderer as _kernels
from ..light.kinds import Light, _table
from ..scene import Material

if TYPE_CHECKING:
    from ..environment import Environment

__all__ = ["shade"]

METHODS = ("sampling", "ltc", "representative_point", "point")


def shade(
    points: ArrayLike,
    normals: ArrayLike,
    materials: Material | brdf.Model | Sequence[Material | brdf.Model],
    lights: Light | Sequence[Light],
    *,
    wo: ArrayLike | None = None,
    eye: ArrayLike | None = None,
    material_ids: ArrayLike | None = None,
    colors: ArrayLike | None = None,
    geometric_normals: ArrayLike | None = None,
    inside: ArrayLike | None = None,
    lit: Sequence[ArrayLike | None] | None = None,
    environment: Environment | None = None,
    method: str | Sequence[str] = "sampling",
    samples: int | Sequence[int] = 16,
    seed: int = 0,
    out: Floats | None = None,
    progress: bool | Callable[[int, int], object] | None = None,
) -> Floats:
    """The radiance that surfaces of any material reflect from any lights, each as much as is said to arrive.

    Parameters
    ----------
    points, normals : array_like, shape (..., 3)
        Points of surfaces and unit (shading) normals on the side that is seen. Their precision governs.
    materials : Material or model of shadelab.brdf, or sequence of them
        What `material_ids` index; one alone is that of all points.
    lights : light or sequence of lights
        Their sum is returned.
    wo : array_like, shape (..., 3), optional
        Unit directions to the eye. Either this or `eye` is needed.
    eye : array_like, shape (3,), optional
        The eye's position.
    material_ids : array_like of int, shape (...), optional
        Of each point; a negative one marks no surface, whose radiance is zero.
    colors : array_like, shape (..., 3), optional
        By which the materials' colours are multiplied, in [0, 1]; NaN where one is beyond.
    geometric_normals : array_like, shape (..., 3), optional
        Unit normals of the faces, on the side that is seen: light from below them does not arrive. NaN where one is
        zero or NaN.
    inside : array_like of bool, shape (...), optional
        Where a body that light passes is seen from within.
    lit : sequence of array_like of shape (...), or of None, optional
        Of each light the fraction that arrives, in [0, 1], NaN where one is beyond; None: all of it.
    environment : Environment, optional
        A panorama that shines as well, with nothing before it.
    method : {"sampling", "ltc", "representative_point", "point"}, or sequence of them
        How light from areas is found, for all materials or for each: averaged over points of the light and directions
        of the lobe; the diffuse part in closed form and the mirrors' by linearly transformed cosines, or from one point
        of the light; or everything as if it came from the light's middle. Models whose mirrors are not GGX under
        Schlick's Fresnel take samples for the second and third; ambient light and panoramas always do.
    samples : int, or sequence of int
        For all materials or for each.
    seed : int
        Of the samples.
    out : ndarray, optional
        Where to write.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Returns
    -------
    ndarray, shape (..., 3)
        Radiance towards the eye in W/(m² sr), per channel; zero seen from below an opaque surface, NaN where a point or
        direction is.

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit, an index is out of the table, or neither or both of `wo` and `eye` are given.

    Notes
    -----
    Materials are those of `shadelab.pathtrace`, by the same kernels. Beams of punctual lights are exact; point and
    directional lights on metallic-roughness, specular-glossiness and diffuse materials are summed for eight points at
    once. "sampling" is unbiased: scrambled Sobol' points of the light and draws of the model, weighed by the balance
    heuristic. The same bits for the same seed, whatever the threads.

    References
    ----------
    M. Deering and others, *The triangle processor and normal vector shader: a VLSI system for high performance
    graphics*, 1988.
    E. Veach, L. Guibas, *Optimally combining sampling techniques for Monte Carlo rendering*, 1995.

    Examples
    --------
    >>> from shadelab.light import DirectionalLight
    >>> sun, up = DirectionalLight((0, -1, 0), irradiance=(np.pi,) * 3), [0.0, 1.0, 0.0]
    >>> shade([0.0, 0.0, 0.0], up, brdf.Diffuse((0.5, 0.25, 0.0)), sun, wo=up)
    array([0.5 , 0.25, 0.  ])
    """
    if (wo is None) == (eye is None):
        raise ValueError("wo: expected either wo or eye, got " + ("neither" if wo is None else "both"))
    for name, needed in (("points", points), ("normals", normals), ("materials", materials), ("lights", lights)):
        if needed is None:
            raise TypeError(f"{name}: expected something, got None")
    packed, count = _table("lights", lights), 1 if isinstance(lights, Light) else len(lights)
    dtype = _arrays.result_dtype(points=points, normals=normals)
    core: dict[str, tuple[Floats, int]] = {}
    for name, value in (
        ("points", points),
        ("normals", normals),
        ("wo", wo),
        ("geometric_normals", geometric_normals),
        ("colors", colors),
    ):
        if value is not None:
            core[name] = (_arrays.vectors(name, value, 3, dtype), 1)
    shape, flat = _arrays.broadcast(core)
    given = dict(zip(core, flat, strict=True))
    if eye is not None:
        position = _arrays.vectors("eye", eye, 3, dtype)
        if position.shape != (3,):
            raise ValueError(f"eye: expected shape (3,), got {position.shape}")
        given["wo"] = position.reshape(1, 3)
    kinds, rows = _materials(materials, dtype)
    methods = [_arrays.choice("method", m, METHODS) for m in _each("method", method, str, len(kinds))]
    numbers = [_arrays.count("samples", n, 0, 1 << 20) for n in _each("samples", samples, int, len(kinds))]
    how = np.array([(METHODS.index(m), n) for m, n in zip(methods, numbers, strict=True)], np.int32)
    ids = None if material_ids is None else _ids(material_ids, shape, len(kinds))
    flags = None if inside is None else _flags(inside, shape)
    fractions = _fractions(lit, count, shape, dtype)
    sky = None if environment is None else _sky(environment, dtype)
    out = _arrays.output("out", out, (*shape, 3), dtype)
    _kernels.shade(
        (given["points"], given["normals"], given["wo"]),
        eye is not None,
        (given.get("geometric_normals"), flags, given.get("colors"), ids),
        (kinds, rows, how),
        packed,
        fractions,
        sky,
        _arrays.count("seed", seed, 0, 2**64 - 1),
        out.reshape(-1, 3),
        _arrays.progress_callback(progress, "shade"),
    )
    return out


def _materials(materials: Any, dtype: np.dtype[Any]) -> tuple[NDArray[np.int32], Floats]:
    """Kinds and rows of the table."""
    several = [materials] if isinstance(materials, Material | brdf.Model) else list(materials)
    if not several or not all(isinstance(m, Material | brdf.Model) for m in several):
        raise TypeError("materials: expected one Material, or model of shadelab.brdf, or more")
    models = [m._model() if isinstance(m, Material) else m for m in several]
    return np.array([m._number() for m in models], np.int32), np.array([m._row() for m in models], dtype)


def _each(name: str, value: Any, kind: type, count: int) -> list[Any]:
    """One for all materials, or one each."""
    if isinstance(value, kind) or np.ndim(value) == 0:
        return [value] * count
    if len(value) != count:
        raise ValueError(f"{name}: expected one, or one for each of {count} materials, got {len(value)}")
    return list(value)


def _spread(name: str, array: NDArray[Any], shape: tuple[int, ...], dtype: Any) -> NDArray[Any]:
    """One number for each point."""
    try:
        return np.ascontiguousarray(np.broadcast_to(array, shape), dtype).reshape(-1)
    except ValueError:
        raise ValueError(f"{name}: expected shape {shape}, got {array.shape}") from None


def _flags(given: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    flags = np.asarray(given)
    if flags.dtype != np.bool_:
        raise TypeError(f"inside: expected booleans, got dtype {flags.dtype}")
    return _spread("inside", flags, shape, np.bool_)


def _ids(given: ArrayLike, shape: tuple[int, ...], count: int) -> NDArray[np.int32]:
    ids = np.asarray(given)
    if ids.dtype.kind not in "iu":
        raise TypeError(f"material_ids: expected integers, got dtype {ids.dtype}")
    if ids.size and int(ids.max()) >= count:
        raise ValueError(f"material_ids: index {int(ids.max())} is out of range [-1, {count})")
    if ids.dtype.kind == "i":
        # Before the cast: the least of other integers would come round to a row.
        ids = np.maximum(ids, -1)
    return _spread("material_ids", ids, shape, np.int32)


def _fractions(lit: Any, count: int, shape: tuple[int, ...], dtype: Any) -> list[Floats | None]:
    if lit is None:
        return [None] * count
    if len(lit) != count:
        raise ValueError(f"lit: expected one for each of {count} lights, got {len(lit)}")
    return [None if x is None else _spread("lit", _arrays.floats("lit", x, dtype), shape, dtype) for x in lit]


def _sky(environment: Any, dtype: np.dtype[Any]) -> Any:
    from ..environment import Environment

    if not isinstance(environment, Environment):
        raise TypeError(f"environment: expected an Environment, got {type(environment).__name__}")
    return environment._panorama(dtype)
