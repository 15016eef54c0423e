"""Meshes, rays and hits as arrays: what every structure takes and gives."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats

__all__ = ["AllHits", "Hit", "Progress", "flat", "hit_arrays", "ignored", "mesh_arrays", "ray_arrays"]

Progress = bool | Callable[[int, int], object] | None


class Hit(NamedTuple):
    """Where rays meet a mesh; every array has the rays' shape.

    The point is `(1 - u - v) a + u b + v c` of the face's vertices, and `origin + t direction`. A miss has `t`
    infinite, `face` -1, `u` and `v` zero. What is no ray (see `BVH.closest_hit`) has `t`, `u`, `v` NaN and `face` -1.
    """

    t: Floats
    """Distance in units of the direction's length."""
    face: NDArray[np.int32]
    u: Floats
    v: Floats
    normal: Floats | None = None
    """Unit normals of the faces by their winding, (..., 3), if asked for; NaN at misses and on faces without area."""


class AllHits(NamedTuple):
    """Every hit of a batch of rays, one ray after the other; each ray's by `t`, then by face."""

    offsets: NDArray[np.int64]
    """Where each ray's hits begin, and where the last one's end: (rays + 1,). Rays count in the batch's C order."""
    t: Floats
    face: NDArray[np.int32]
    u: Floats
    v: Floats

    @property
    def ray(self) -> NDArray[np.int64]:
        """The index of each hit's ray in the flattened batch."""
        return np.repeat(np.arange(len(self.offsets) - 1), np.diff(self.offsets))


def mesh_arrays(positions: ArrayLike, faces: ArrayLike) -> tuple[Floats, NDArray[np.int32]]:
    p = _arrays.vectors("positions", positions)
    if p.ndim != 2:
        raise ValueError(f"positions: expected shape (V, 3), got {p.shape}")
    array = _arrays.array("faces", faces)
    f = _arrays.indices("faces", array.reshape(0, 3) if array.size == 0 else array, 3, p.shape[0])
    if f.shape[0] > 2**27:
        raise ValueError(f"faces: expected at most {2**27}, got {f.shape[0]}")
    if len(p):
        # Column by column: extremes along the short axis of an array are slow.
        low, high = (np.array([extreme(p[:, k]) for k in range(3)], float) for extreme in (np.min, np.max))
        if not (np.isfinite(low).all() and np.isfinite(high).all()):
            at = int(np.argwhere(~np.isfinite(p).all(-1))[0, 0])
            raise ValueError(f"positions: vertex {at} is not finite: {p[at].tolist()}")
        # Products of three edges must neither overflow nor vanish.
        largest, smallest = (1e18, 1e-12) if p.dtype == np.float32 else (1e150, 1e-100)
        if max(-low.min(), high.max()) > largest:
            at = int(np.abs(p).max(-1).argmax())
            raise ValueError(f"positions: vertex {at} lies beyond {largest:g}: {p[at].tolist()}; scale the mesh down")
        extent = float((high - low).max())
        if 0.0 < extent < smallest:
            raise ValueError(f"positions: extent {extent:g} is below {smallest:g}; scale the mesh up")
    return p, f


def ray_arrays(
    dtype: np.dtype[Any],
    faces: int,
    origins: ArrayLike,
    directions: ArrayLike,
    t_min: ArrayLike,
    t_max: ArrayLike,
    ignore_face: ArrayLike | None,
    ignore_instance: ArrayLike | None = None,
    instances: int | None = None,
) -> tuple[tuple[int, ...], list[NDArray[Any]]]:
    """The batch's shape; origins, directions, t_min, t_max and what is ignored, of its length or of length one."""
    core: dict[str, tuple[NDArray[Any], int]] = {
        "origins": (_arrays.vectors("origins", origins, 3, dtype), 1),
        "directions": (_arrays.vectors("directions", directions, 3, dtype), 1),
    }
    for name, value in (("t_min", t_min), ("t_max", t_max)):
        core[name] = (_arrays.knob_array(name, value, dtype), 0)
    core["ignore_face"] = (ignored("ignore_face", ignore_face, "a face", faces), 0)
    if instances is not None:
        core["ignore_instance"] = (ignored("ignore_instance", ignore_instance, "an instance", instances), 0)
    # What is one for all stays one.
    many = {n: c for n, c in core.items() if c[1] or c[0].ndim}
    shape, flat = _arrays.broadcast(many)
    arrays = dict(zip(many, flat, strict=True))
    return shape, [arrays.get(n, core[n][0].reshape(-1)) for n in core]


def ignored(name: str, given: ArrayLike | None, what: str, limit: int) -> NDArray[np.int32]:
    if given is None:
        return np.array(-1, np.int32)
    array = _arrays.array(name, given)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name}: expected integers, got dtype {array.dtype}")
    bad = (array < -1) | (array >= max(limit, 1))
    if bad.any():
        raise ValueError(f"{name}: expected -1 or {what} below {limit}, got {array[bad].flat[0]}")
    return np.require(array, np.int32, ["C", "A"])


def hit_arrays(shape: tuple[int, ...], dtype: np.dtype[Any], normals: bool, out: Hit | None) -> Hit:
    given: Any = out if out is not None else Hit(*[None] * 4)  # type: ignore[arg-type]
    if not isinstance(given, Hit):
        raise TypeError(f"out: expected a Hit, got {type(out).__name__}")
    t, u, v = (_arrays.output(f"out.{n}", getattr(given, n), shape, dtype) for n in "tuv")
    face = _arrays.output("out.face", given.face, shape, np.int32)
    normal = _arrays.output("out.normal", given.normal, (*shape, 3), dtype) if normals else None
    if out is not None:
        named = {"t": t, "face": face, "u": u, "v": v} | ({} if normal is None else {"normal": normal})
        for (a, x), (b, y) in combinations(named.items(), 2):
            if np.may_share_memory(x, y):
                raise ValueError(f"out.{a}: shares memory with out.{b}")
    return Hit(t, face, u, v, normal)


def flat(hit: Hit) -> list[NDArray[Any]]:
    return [hit.t.reshape(-1), hit.face.reshape(-1), hit.u.reshape(-1), hit.v.reshape(-1)]
