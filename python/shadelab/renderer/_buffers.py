"""The surfaces that pixels show."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import light, mesh, raster, shadow
from .._arrays import Floats
from ._facts import corners_of


@dataclass(frozen=True)
class Seen:
    """The surfaces that pixels show; arrays of receivers hold the covered pixels alone, row by row."""

    face: NDArray[np.int32]
    covered: NDArray[np.bool_]
    points: Floats
    geometric: Floats
    shading: Floats
    base_color: Floats
    material: NDArray[np.int32]

    def spread(self, values: Floats, fill: float) -> Floats:
        """Values of receivers as a picture."""
        picture = np.full((*self.covered.shape, *values.shape[1:]), fill, values.dtype)
        picture[self.covered] = values
        return picture


def g_buffer(arrays: Any, camera: Any, size: tuple[int, int]) -> Seen:
    """Visible faces, points and normals; both sides of a surface are looked at as its front."""
    matrix = camera.projection(size[0] / size[1], depth="reversed") @ camera.view()
    positions = np.concatenate([arrays.positions, np.ones((len(arrays.positions), 1))], axis=-1)
    clip = (positions @ matrix.T).astype(np.float32)
    drawn = raster.g_buffer(
        clip,
        arrays.faces,
        arrays.positions,
        size,
        normals=arrays.normals,
        material_ids=arrays.material_ids,
        depth="reversed",
    )
    covered = drawn.face >= 0
    face, points, shading = drawn.face[covered], drawn.position[covered], drawn.normal[covered]
    geometric = np.nan_to_num(mesh.face_normals(arrays.positions, arrays.faces))[face]
    shading = np.where(shading.any(-1, keepdims=True), shading, geometric)
    away = points - np.asarray(camera.eye, np.float32)
    geometric = np.where(np.einsum("ij,ij->i", geometric, away)[:, None] > 0, -geometric, geometric)
    shading = np.where(np.einsum("ij,ij->i", shading, geometric)[:, None] < 0, -shading, shading)
    material = drawn.material[covered]
    base = arrays.base_color[material]
    if arrays.colors is not None:
        where = raster.Raster(drawn.face, drawn.u, drawn.v, drawn.depth)
        base = base * raster.interpolate(arrays.colors, arrays.faces, where)[covered]
    points, geometric, shading, base = (np.ascontiguousarray(x, np.float32) for x in (points, geometric, shading, base))
    return Seen(drawn.face, covered, points, geometric, shading, base, material)


def above_horizon(lamp: Any, seen: Seen) -> NDArray[np.bool_]:
    """Whether any part of a light is above the plane of the surface itself, whatever the shading normal says."""
    n = seen.geometric
    if isinstance(lamp, light.DirectionalLight):
        # Of unit length before it is rounded: in single precision 1e-300 is nothing.
        direction = shadow._unit("direction", np.asarray(lamp.direction, np.float64))
        return np.asarray(n @ direction.astype(n.dtype) < 0)
    corners = [np.asarray(lamp.position)] if isinstance(lamp, light.PointLight) else corners_of(lamp)
    here = np.einsum("ij,ij->i", seen.points, n)
    return np.asarray(np.max([n @ corner.astype(n.dtype) for corner in corners], axis=0) > here)
