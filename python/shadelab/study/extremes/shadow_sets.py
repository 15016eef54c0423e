"""Extremes of `shadow`: stored depths of a sliver and of nothing, cascade borders, edges of cubes, the last page."""

from __future__ import annotations

import numpy as np

from ... import shadow
from ...light import DirectionalLight, PointLight
from ...scene import Camera
from ..stability import Measurement, extreme

_QUAD = [[0, 2, 1], [0, 3, 2]]
_SQUARE = np.array([[-1.0, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]])


@extreme(
    "shadow.shadow_map",
    "depths stored in 16, 24 and 32 bits",
    domain="ranges of 0 to 1e6 at a depth of 1e3",
    unit="steps",
    claim=0.51,
)
def _stored(dtype: np.dtype) -> Measurement:
    worst, cases, strays = 0.0, 0, 0
    for drop in (0.0, 1.0, 1e6):
        # Askew, so that depths lie anywhere between the steps.
        low = _SQUARE * (5.0 + drop) - [0, 1000.0, 0]
        low[:, 1] -= drop * np.array([0.4, 0.6, 1.0, 0.8])
        high = _SQUARE * [0.2, 0, 0.2] - [0, 1000.0, 0]
        points = np.concatenate([low, high]).astype(dtype)
        faces = [*_QUAD, [4, 6, 5], [4, 7, 6]]
        exact = shadow.shadow_map(points, faces, PointLight((0.0, 0, 0)), 32)
        drawn = np.isfinite(exact.depth)
        for bits in (16, 24, 32):
            m = shadow.shadow_map(points, faces, PointLight((0.0, 0, 0)), 32, bits=bits)
            found = m.depths()
            strays += int((np.isfinite(found) != drawn).sum())
            # Roundings of the depth itself are not the format's.
            own = 2 * float(np.finfo(dtype).eps) * m.far
            off = np.abs(found[drawn].astype(np.float64) - exact.depth[drawn]) - own
            if m.step > 0:
                worst = max(worst, float(off.max()) / m.step)
            else:
                strays += int((off > 0).sum())
            cases += int(drawn.sum())
    return Measurement(worst, cases, strays)


@extreme("shadow.cascades", "receivers on the cuts", domain="a rounding about each cut", unit="count", claim=0)
def _cuts(dtype: np.dtype) -> Measurement:
    ground = (_SQUARE * 60.0).astype(dtype)
    roof = (_SQUARE * 60.0 + [0, 3.0, 0]).astype(dtype)
    sun, camera = DirectionalLight((0.2, -1.0, 0.1)), Camera((0, 1, 0), (0, 1, -1), near=0.5, far=50.0)
    wrong, cases = 0, 0
    for positions, lit in ((ground, 1.0), (np.concatenate([ground, roof]), 0.0)):
        faces = _QUAD if lit else [*_QUAD, [4, 5, 6], [4, 6, 7]]
        for blend in (0.0, 0.1, 0.99):
            maps = shadow.cascades(positions, faces, sun, camera, 64, blend=blend)
            cuts = maps.splits[:-1].astype(dtype)
            z = np.concatenate([np.nextafter(cuts, dtype.type(0)), cuts, np.nextafter(cuts, dtype.type(99))])
            points = np.stack([0 * z, 0 * z, -z], -1)
            wrong += int((shadow.hard(maps, points, [0, 1, 0]) != lit).sum())
            cases += len(z)
    return Measurement(wrong, cases)


@extreme(
    "shadow.cube_shadow_map", "receivers on edges and corners of the cube", domain="cubes of 1e-3 to 1e3", unit="count",
    claim=0,
)  # fmt: skip
def _edges(dtype: np.dtype) -> Measurement:
    wrong, cases = 0, 0
    at = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) != (0, 0, 0)])
    corners = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1, 1) for z in (-1, 1)])
    sides = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]
    box = [[s[i], s[j], s[k]] for s in sides for i, j, k in ((0, 1, 2), (0, 2, 3))]
    for scale in (1e-3, 1.0, 1e3):
        cube = shadow.cube_shadow_map((corners * scale).astype(dtype), box, PointLight((0.0, 0, 0)), 64)
        for far, lit in ((0.5, 1.0), (2.0, 0.0)):
            found = shadow.hard(cube, (at * scale * far).astype(dtype))
            wrong += int((found != lit).sum())
            cases += len(at)
    return Measurement(wrong, cases)


@extreme(
    "shadow.virtual_shadow_map", "the last page of 16384 texels", domain="corners of the map", unit="count", claim=0
)
def _pages(dtype: np.dtype) -> Measurement:
    points = np.concatenate([_SQUARE, _SQUARE + np.array([0, 1.0, 0])]).astype(dtype)
    faces = [*_QUAD, [4, 6, 5], [4, 7, 6]]
    seen = (0.999 * _SQUARE).astype(dtype)
    large = shadow.virtual_shadow_map(points, faces, DirectionalLight((0, -1, 0)), seen, 16384, page=64)
    dark, above = (
        shadow.hard(large, seen, [0, 1, 0]),
        shadow.hard(large, seen + dtype.type(2) * np.array([0, 1, 0], dtype), [0, 1, 0]),
    )
    return Measurement(float((dark != 0).sum() + (above != 1).sum() + (large.hit_rate(seen) != 1)), 9)
