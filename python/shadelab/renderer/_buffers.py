"""The surfaces that pixels show."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import mesh, raster
from .._arrays import Floats
from ._facts import highest


@dataclass(frozen=True)
class Seen:
    """The surfaces that pixels show; arrays of receivers hold the covered pixels alone, row by row."""

    face: NDArray[np.int32]
    covered: NDArray[np.bool_]
    points: Floats
    geometric: Floats
    shading: Floats
    inside: NDArray[np.bool_]
    """Whether a face is seen from behind."""
    colors: Floats | None
    """Factors of the materials' colours."""
    material: NDArray[np.int32]
    u: Floats
    v: Floats
    """Where on their faces, by barycentric coordinates."""

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
    flat = np.nan_to_num(mesh.face_normals(arrays.positions, arrays.faces))
    geometric = flat[face]
    away = points - np.asarray(camera.eye, np.float32)
    if not flat.any(-1).all():
        # Faces so small that they have no normal take that of the vertices, else face the eye.
        towards = -away / np.linalg.norm(away, axis=-1, keepdims=True)
        spare = np.where(shading.any(-1, keepdims=True), shading, towards)
        geometric = np.where(geometric.any(-1, keepdims=True), geometric, spare)
    shading = np.where(shading.any(-1, keepdims=True), shading, geometric)
    inside = np.einsum("ij,ij->i", geometric, away) > 0
    geometric = np.where(inside[:, None], -geometric, geometric)
    shading = np.where(np.einsum("ij,ij->i", shading, geometric)[:, None] < 0, -shading, shading)
    material = drawn.material[covered]
    colors = None
    if arrays.colors is not None:
        where = raster.Raster(drawn.face, drawn.u, drawn.v, drawn.depth)
        colors = np.ascontiguousarray(raster.interpolate(arrays.colors, arrays.faces, where)[covered], np.float32)
    # Where interpolation turns the normal away from the eye (silhouettes), the face's serves.
    shading = np.where(np.einsum("ij,ij->i", shading, away)[:, None] >= 0, geometric, shading)
    points, geometric, shading = (np.ascontiguousarray(x, np.float32) for x in (points, geometric, shading))
    return Seen(
        drawn.face, covered, points, geometric, shading, inside, colors, material, drawn.u[covered], drawn.v[covered]
    )


def above_horizon(lamp: Any, seen: Seen) -> NDArray[np.bool_]:
    """Whether any part of a light with an outline is above the plane of the surface itself."""
    return np.asarray(highest(lamp, seen.geometric) > np.einsum("ij,ij->i", seen.points, seen.geometric))
