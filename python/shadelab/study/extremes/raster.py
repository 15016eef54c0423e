"""Extremes of `raster`: coverage counted, coordinates and depth against extended precision."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import raster
from ..stability import Measurement, extreme

SIZE = (64, 48)


def _to_clip(pixels: NDArray[Any], w: NDArray[Any], size: tuple[int, int] = SIZE) -> NDArray[np.float64]:
    """Vertices at pixel positions (n, 2), of given w, halfway between near and far."""
    x, y = 2 * pixels[:, 0] / size[0] - 1, 1 - 2 * pixels[:, 1] / size[1]
    return np.stack([x * w, y * w, 0 * w, w], -1)


def _owners(clip: NDArray[Any], faces: NDArray[Any], samples: int = 1) -> NDArray[np.int64]:
    """How many of the faces, drawn alone, cover each sample."""
    return sum((raster.rasterize(clip, f[None], SIZE, samples).face == 0).astype(np.int64) for f in faces)


@extreme(
    "raster.rasterize",
    "shared edges, 1e5 pixels wide",
    domain="two triangles about an edge through the picture, cut by every guard plane",
    unit="count",
    claim=0,
)
def shared_edges(dtype: np.dtype) -> Measurement:
    """Samples that two triangles about an edge cover not exactly once."""
    rng = np.random.default_rng(1)
    wrong = cases = 0
    for _ in range(40):
        along = rng.normal(size=2)
        along *= 1e5 / np.linalg.norm(along)
        side, centre = np.array([-along[1], along[0]]), rng.integers(0, 96, 2) / 2
        pixels = np.array([centre - along, centre + along, centre + side, centre - side])
        clip = _to_clip(pixels, rng.uniform(0.5, 2, 4)).astype(dtype)
        owners = _owners(clip, np.array([[0, 1, 2], [1, 0, 3]]))
        wrong += int((owners != 1).sum())
        cases += owners.size
    return Measurement(wrong, cases)


@extreme(
    "raster.rasterize",
    "fans of slivers on the samples",
    domain="vertices on sample positions, slivers down to 1/256 pixel, 4 samples",
    unit="count",
    claim=0,
)
def fans(dtype: np.dtype) -> Measurement:
    """Samples that a fan beyond the picture covers not exactly once."""
    rng = np.random.default_rng(2)
    wrong = cases = 0
    for _ in range(6):
        n = 60
        angles = np.sort(np.concatenate([np.arange(6), rng.uniform(0, 6, n - 6)])) * (2 * np.pi / 6)
        rim = 24 + 90 * np.stack([np.cos(angles), np.sin(angles)], -1)
        apex = rng.integers(300, 500, (1, 2)) / 16
        clip = _to_clip(np.concatenate([apex, rim]), np.ones(n + 1)).astype(dtype)
        k = np.arange(n)
        owners = _owners(clip, np.stack([0 * k, 1 + k, 1 + (k + 1) % n], -1), 4)
        wrong += int((owners != 1).sum())
        cases += owners.size
    return Measurement(wrong, cases)


@extreme(
    "raster.rasterize",
    "last pixel of 16384",
    domain="an edge within one subpixel of the last centre of the largest picture",
    unit="count",
    claim=0,
)
def subpixel_grid(dtype: np.dtype) -> Measurement:
    """Edges whose side of the last pixel's centre is mistaken."""
    wrong = cases = 0
    for step in range(-8, 9):
        x = 16383.5 + step / 256
        clip = _to_clip(np.array([[x, -5], [16400, -5], [x, 20.0]]), np.ones(3), (16384, 2)).astype(dtype)
        seen = raster.rasterize(clip, [[0, 1, 2]], (16384, 2)).face
        # An edge on the centre is a left one here, and owns it.
        wrong += int((seen[0, -1] == 0) != (step <= 0)) + int((seen[:, :-1] == 0).sum())
        cases += 1
    return Measurement(wrong, cases)


def _through_the_eye(dtype: np.dtype, reach: float) -> tuple[NDArray[Any], NDArray[Any]]:
    """Walls and floors from behind the eye to a distance of `reach`: clip positions and faces."""
    rng = np.random.default_rng(3)
    n = 40
    positions = rng.normal(size=(n, 3, 3)) * [2, 2, 1]
    positions[:, 0, 2] = rng.uniform(0.2, 2, n)
    positions[:, 1:, 2] = -rng.uniform(1, reach, (n, 2))
    positions[:, 1:, :2] *= reach
    near, far = 0.1, 2 * reach
    k = (far + near) / (near - far), 2 * far * near / (near - far)
    x, y, z = positions.reshape(-1, 3).T
    return np.stack([1.5 * x, 2 * y, k[0] * z + k[1], -z], -1).astype(dtype), np.arange(3 * n).reshape(n, 3)


def _exact(clip: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """u, v and z / w of one triangle at pixel centres, in extended precision."""
    v = clip.astype(np.longdouble)
    j, i = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
    p = np.stack([2 * j / SIZE[0] - 1, 1 - 2 * i / SIZE[1], np.ones_like(i)], -1).astype(np.longdouble)
    h = v[:, [0, 1, 3]]
    weights = [(p * np.cross(h[(k + 1) % 3], h[(k + 2) % 3])).sum(-1) for k in range(3)]
    total = weights[0] + weights[1] + weights[2]
    z, w = (sum(weights[k] * v[k, c] for k in range(3)) for c in (2, 3))
    return weights[1] / total, weights[2] / total, z / w


@extreme(
    "raster.rasterize",
    "barycentrics through the eye's plane",
    domain="triangles from behind the eye to 1000 away, clear of their edges by 1e-3 in u, v",
    unit="absolute",
    claim={"float32": 2e-4, "float64": 1e-12},
)
def barycentrics(dtype: np.dtype) -> Measurement:
    """Error of u and v, of triangles that the near plane cuts."""
    clip, faces = _through_the_eye(dtype, 1e3)
    error, cases, strays = 0.0, 0, 0
    for f in faces:
        seen = raster.rasterize(clip, f[None], SIZE)
        u, v, _ = _exact(clip[f])
        clear = (seen.face == 0) & (np.minimum(np.minimum(u, v), 1 - u - v) > 1e-3)
        strays += int((~np.isfinite(seen.u) | ~np.isfinite(seen.v)).sum())
        cases += int(clear.sum())
        if clear.any():
            off = np.maximum(np.abs(seen.u - u), np.abs(seen.v - v))[clear]
            error = max(error, float(off.max()))
    return Measurement(error, cases, strays)


@extreme(
    "raster.rasterize",
    "depth through the eye's plane",
    domain="triangles from behind the eye to 1000 away, near plane at 0.1, clear of their edges",
    unit="absolute",
    claim={"float32": 1e-6, "float64": 4e-15},
)
def depths(dtype: np.dtype) -> Measurement:
    """Error of z / w, of triangles that the near plane cuts."""
    clip, faces = _through_the_eye(dtype, 1e3)
    error, cases, strays = 0.0, 0, 0
    for f in faces:
        seen = raster.rasterize(clip, f[None], SIZE)
        u, v, z = _exact(clip[f])
        clear = (seen.face == 0) & (np.minimum(np.minimum(u, v), 1 - u - v) > 1e-3)
        strays += int(np.isnan(seen.depth).sum())
        cases += int(clear.sum())
        if clear.any():
            error = max(error, float(np.abs(seen.depth - z)[clear].max()))
    return Measurement(error, cases, strays)


@extreme(
    "raster.rasterize",
    "vertices of any size",
    domain="components from the least subnormal to the largest finite number, zeros, infinities, NaN",
    unit="count",
    claim=0,
)
def any_size(dtype: np.dtype) -> Measurement:
    """Coordinates outside the triangle or depths outside the planes, of wild vertices."""
    rng = np.random.default_rng(4)
    info = np.finfo(dtype)
    n = 20000
    low, high = np.log2(float(info.smallest_subnormal)), np.log2(float(info.max))
    with np.errstate(over="ignore", invalid="ignore"):
        clip = (rng.choice([-1.0, 1.0], (3 * n, 4)) * 2.0 ** rng.uniform(low, high, (3 * n, 4))).astype(dtype)
        clip[:, 3] = np.abs(clip[:, 3])
        half = 3 * n // 2
        within = (rng.uniform(-2, 2, (half, 3)) * clip[:half, 3:].astype(np.longdouble)).astype(dtype)
    special = np.array([0.0, -0.0, np.inf, -np.inf, np.nan, info.max, info.smallest_subnormal], dtype)
    clip = np.where(rng.random(clip.shape) < 0.1, rng.choice(special, clip.shape), clip)
    clip[:, 3] = np.abs(clip[:, 3])
    # Half of them about the picture, at any scale.
    clip[:half, :3] = within
    clip[:half, 3] = np.abs(clip[:half, 3])
    wrong = covered = 0
    strays = 0
    for k in range(0, n, 100):
        faces = np.arange(3 * k, 3 * k + 300).reshape(-1, 3)
        seen = raster.rasterize(clip, faces, (16, 16))
        hit = seen.face >= 0
        strays += int((~np.isfinite(seen.u) | ~np.isfinite(seen.v) | np.isnan(seen.depth)).sum())
        u, v, z = seen.u[hit], seen.v[hit], seen.depth[hit]
        wrong += int(((u < 0) | (v < 0) | (u + v > 1 + 4 * info.eps) | (np.abs(z) > 1)).sum())
        covered += int(hit.sum())
    return Measurement(wrong, covered, strays)
