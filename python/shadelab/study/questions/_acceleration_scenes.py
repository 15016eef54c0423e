"""Meshes of different make, on which structures differ."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import mesh
from ...mesh import Mesh

__all__ = ["RAYS", "SCENES"]

Array = NDArray[Any]

FACES = 6_000
"""About as many faces has every scene, so that builds compare."""


def _soup(corners: Array) -> Mesh:
    """Triangles that share nothing, (n, 3, 3)."""
    return Mesh(corners.reshape(-1, 3).astype(np.float32), np.arange(corners.size // 3, dtype=np.int32).reshape(-1, 3))


def uniform() -> Mesh:
    """Small triangles of one size, spread evenly over a cube."""
    rng = np.random.default_rng(1)
    centres = rng.uniform(-1, 1, (FACES, 1, 3))
    return _soup(centres + 0.045 * rng.uniform(-1, 1, (FACES, 3, 3)))


def clustered() -> Mesh:
    """A dozen dense clusters in an empty cube."""
    rng = np.random.default_rng(2)
    middles = rng.uniform(-0.9, 0.9, (12, 3))[rng.integers(12, size=FACES)]
    centres = middles[:, None] + 0.06 * rng.normal(size=(FACES, 1, 3))
    return _soup(centres + 0.03 * rng.uniform(-1, 1, (FACES, 3, 3)))


def thin() -> Mesh:
    """Long thin triangles across the cube in every direction, like hair or grass."""
    rng = np.random.default_rng(3)
    begin = rng.uniform(-1, 1, (FACES, 1, 3))
    along = rng.normal(size=(FACES, 1, 3))
    along *= 0.5 / np.linalg.norm(along, axis=-1, keepdims=True)
    return _soup(begin + along * np.array([[0.0], [1.0], [0.5]]) + 0.003 * rng.normal(size=(FACES, 3, 3)))


def nested() -> Mesh:
    """Shells of triangles around one point, each three times smaller than the last, down to a billionth."""
    rng = np.random.default_rng(4)
    scale = 3.0 ** -rng.integers(0, 20, (FACES, 1, 1))
    outward = rng.normal(size=(FACES, 1, 3))
    outward /= np.linalg.norm(outward, axis=-1, keepdims=True)
    return _soup(scale * (outward + 0.05 * rng.normal(size=(FACES, 3, 3))))


def stadium() -> Mesh:
    """A finely meshed torus, a hundredth of the scene in size, amid the steps of an arena."""
    torus = mesh.torus(1.0, 0.4, 72, 36)
    parts = [(torus.positions * 0.01 + [0, 0.02, 0], torus.faces)]
    for i in range(12):
        # Rings of steps, squares of few and large triangles.
        side, height = 0.5 + 0.08 * i, 0.04 * i
        for x, z in ((0, side), (0, -side), (side, 0), (-side, 0)):
            w, d = (0.04, side) if x else (side, 0.04)
            step = mesh.box()
            parts.append(((step.positions * [2 * w, 0.04, 2 * d] + [x, height, z]), step.faces))
    ground = mesh.plane()
    parts.append((ground.positions * [3, 1, 3], ground.faces))
    starts = np.cumsum([0, *(len(p) for p, _ in parts)])
    faces = np.concatenate([f + s for (_, f), s in zip(parts, starts, strict=False)])
    return Mesh(np.concatenate([p for p, _ in parts]).astype(np.float32), faces.astype(np.int32))


SCENES: Mapping[str, Callable[[], Mesh]] = {
    "uniform": uniform,
    "clustered": clustered,
    "long thin triangles": thin,
    "nested scales": nested,
    "teapot in a stadium": stadium,
}


def _picture(positions: Array, size: tuple[int, int], rng: np.random.Generator) -> tuple[Array, Array]:
    """Rays of a camera before the mesh, towards its densest place."""
    middle = np.median(positions, axis=0)
    extent = float(np.ptp(positions, axis=0).max())
    # So near that what is dense fills a part of the picture.
    spread = float(np.median(np.linalg.norm(positions - middle, axis=-1)))
    eye = middle + np.array([0.4, 0.5, 0.77]) * max(2.5 * spread, 1e-3 * extent)
    back = (eye - middle) / np.linalg.norm(eye - middle)
    right = np.cross([0, 1, 0], back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    width, height = size
    x = (2 * (np.arange(width) + 0.5) / width - 1) * width / height
    y = 1 - 2 * (np.arange(height) + 0.5) / height
    directions = 0.5 * (x[None, :, None] * right + y[:, None, None] * up) - back
    return np.broadcast_to(eye, directions.shape), directions


def _random(positions: Array, size: tuple[int, int], rng: np.random.Generator) -> tuple[Array, Array]:
    """Rays with nothing in common: from anywhere in the mesh's box to one of its vertices."""
    shape = (size[1], size[0], 3)
    low, high = positions.min(0), positions.max(0)
    origins = rng.uniform(low, high, shape)
    return origins, positions[rng.integers(len(positions), size=shape[:2])] - origins


RAYS = {"a camera's rays": _picture, "random rays": _random}
