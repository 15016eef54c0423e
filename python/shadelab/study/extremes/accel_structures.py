"""Extremes of the structures that part space: every hit of every ray against brute force, where cells come to grief."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import accel
from ..stability import Measurement, extreme

Array = NDArray[Any]

STRUCTURES: dict[str, Callable[..., accel.Structure]] = {
    "accel.UniformGrid": accel.UniformGrid,
    "accel.Octree": accel.Octree,
    "accel.KDTree": accel.KDTree,
    "accel.BSPTree": accel.BSPTree,
    "accel.BSPTree polygon_aligned": partial(accel.BSPTree, method="polygon_aligned"),
}


def _nested(rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Triangles of 1e-9 to 1 about one point; rays at their vertices."""
    t = rng.normal(size=(400, 3, 3)) * 10 ** rng.uniform(-9, 0, (400, 1, 1))
    o = rng.normal(size=(500, 3))
    return t, o, t[rng.integers(400, size=500), rng.integers(3, size=500)] - o


def _lattice(rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Triangles and rays in the planes between cells."""
    corner = rng.integers(0, 9, (400, 1, 3)).astype(float)
    axis, unit = rng.integers(3, size=400), np.eye(3)
    t = corner + np.stack([np.zeros((400, 3)), unit[(axis + 1) % 3], unit[(axis + 2) % 3]], 1)
    return (
        t,
        rng.integers(-1, 10, (1500, 3)) * 1.0,
        unit[rng.integers(3, size=1500)] * rng.choice([-1.0, 1.0], (1500, 1)),
    )


def _distant(rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Rays from 1e6 times the scene's size, which by their rounding pass many cells at once."""
    t = rng.normal(size=(200, 1, 3)) + 0.1 * rng.normal(size=(200, 3, 3))
    o = rng.normal(size=(600, 3))
    o *= 1e6 / np.linalg.norm(o, axis=-1, keepdims=True)
    return t, o, t[rng.integers(200, size=600)].mean(1) - o


def _grazing(rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Near-coplanar layers, met at 1e-6: hits lie outside their triangles' boxes."""
    t = rng.uniform(-1, 1, (400, 3, 3))
    t[:, :, 2] = 0.6 * t[:, :, 0] - 0.36 * t[:, :, 1] + rng.uniform(0, 2e-7, (400, 1))
    along = rng.normal(size=(400, 2))
    d = np.concatenate([along, (along @ [0.6, -0.36])[:, None] + 1e-6 * rng.normal(size=(400, 1))], 1)
    return t, t[rng.integers(400, size=400)].mean(1) - 2 * d, d


def _needles(rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Triangles a millionth as high as long, across everything."""
    along = rng.normal(size=(300, 1, 3))
    t = rng.normal(size=(300, 1, 3)) + along * np.array([[0.0], [2.0], [1.0]]) + 1e-6 * rng.normal(size=(300, 3, 3))
    o = 3 * rng.normal(size=(1500, 3))
    return t, o, t[rng.integers(300, size=1500)].mean(1) - o


def _differing(make: Callable[..., accel.Structure], scene: Callable[..., Any], dtype: np.dtype[Any]) -> Measurement:
    """Hits of all rays, and nearest hits, that differ from brute force's in any bit."""
    t, o, d = (a.astype(dtype) for a in scene(np.random.default_rng(7)))
    p, f = t.reshape(-1, 3), np.arange(3 * len(t)).reshape(-1, 3)
    structure = make(p, f)
    found, expected = structure.all_hits(o, d), accel.brute_force_all(p, f, o, d)
    if not len(expected.t):
        raise AssertionError("the extreme tries nothing: no ray hits")
    if len(found.t) != len(expected.t):
        return Measurement(float(abs(len(found.t) - len(expected.t))), len(expected.t))
    differs = np.zeros(len(expected.t), bool)
    for a, b in zip(found[1:], expected[1:], strict=True):
        differs |= (a.view(np.uint8).reshape(len(a), -1) != b.view(np.uint8).reshape(len(a), -1)).any(-1)
    nearest = structure.closest_hit(o, d).face != accel.brute_force(p, f, o, d).face
    return Measurement(float(differs.sum() + nearest.sum()), len(expected.t), int((~np.isfinite(found.t)).sum()))


SCENES = [
    ("nested scales", "triangles of 1e-9 to 1", _nested),
    ("rays in planes between cells", "a lattice of whole numbers", _lattice),
    ("rays from afar", "1e6 times the scene's size", _distant),
    ("near-coplanar layers", "layers 1e-7 apart met at 1e-6", _grazing),
    ("needles", "height 1e-6 of length", _needles),
]

for _name, _make in STRUCTURES.items():
    for _extreme, _domain, _scene in SCENES:
        extreme(_name, _extreme, domain=_domain, unit="count", claim=0)(partial(_differing, _make, _scene))
