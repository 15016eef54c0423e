"""The uniform grid."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import _arrays
from .._kernels import accel as _kernels
from ._rays import Progress, mesh_arrays
from ._structure import Structure

__all__ = ["UniformGrid"]

_MOST = 2048


class UniformGrid(Structure):
    """A grid of equal cells over triangles, walked from cell to cell along the ray.

    Parameters
    ----------
    positions : array_like, shape (V, 3)
        Vertices. Their dtype, float32 or float64, governs every query.
    faces : array_like of int, shape (F, 3)
        Indices of vertices; at most 2**27 faces, also none.
    cells_per_face : float
        How many cells there are for each face, as near to cubes as may be.
    resolution : sequence of three ints, optional
        The cells along x, y and z instead, up to 2048 each.
    mailbox : bool
        Remember the triangles that a ray has met, so that one that stands in many cells is tested once.
    progress : bool or callable, optional
        True for a bar, or called with (done, total).

    Raises
    ------
    TypeError, ValueError
        As `BVH` does; `cells_per_face` is not above zero, or a resolution not from 1 to 2048.

    Notes
    -----
    The structure of scenes whose triangles are of one size, spread evenly: quick to build, and steps from cell to cell
    cost little. A detailed object in a large, empty scene falls into one cell ("the teapot in a stadium"), and long
    triangles into many: while triangles would stand in more than 32 cells on average, or there would be more than 2^27
    cells, the resolution is halved (see `resolution` for what came of it).

    Boxes counted are the cells that the ray visits, those without triangles too. By rounding a ray may be in several
    cells at once: a plane is crossed twice, where the ray may first reach it and where it must have left it, so that
    answers equal `brute_force` to the bit. Far from the scene (10^6 times its size in float32) that makes it slow.

    References
    ----------
    J. Amanatides, A. Woo, *A Fast Voxel Traversal Algorithm for Ray Tracing*, Eurographics 1987. J. G. Cleary,
    G. Wyvill, *Analysis of an Algorithm for Fast Ray Tracing Using Uniform Space Subdivision*, 1988.

    Examples
    --------
    >>> import numpy as np
    >>> triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
    >>> grid = UniformGrid(triangle, [[0, 1, 2]], resolution=(4, 4, 1))
    >>> hit = grid.closest_hit([0.25, 0.5, 2], [0, 0, -1])
    >>> float(hit.t), int(hit.face)
    (2.0, 0)
    """

    _kernel = staticmethod(_kernels.uniform_grid)
    _resolution: Sequence[int]

    def __init__(
        self,
        positions: ArrayLike,
        faces: ArrayLike,
        *,
        cells_per_face: float = 2.0,
        resolution: Sequence[int] | None = None,
        mailbox: bool = True,
        progress: Progress = None,
    ) -> None:
        density, remember = _arrays.number("cells_per_face", cells_per_face, above=0), _arrays.flag("mailbox", mailbox)
        p, f = mesh_arrays(positions, faces)
        if resolution is None:
            corners = p[f.reshape(-1)].astype(np.float64)
            extent = np.ptp(corners, axis=0) if len(corners) else np.zeros(3)
            cells = _resolution(extent, density * f.shape[0])
        else:
            if _arrays.array("resolution", resolution).shape != (3,):
                raise ValueError(f"resolution: expected three numbers of cells, got {resolution}")
            cells = [_arrays.count("resolution", n, 1, _MOST) for n in resolution]
        self._build(p, f, progress, cells, remember)

    def _build(self, positions: ArrayLike, faces: ArrayLike, progress: Progress, *options: Any) -> None:
        super()._build(positions, faces, progress, *options)
        self._tree, self._resolution = self._tree

    @property
    def resolution(self) -> tuple[int, int, int]:
        """The number of cells along x, y and z."""
        x, y, z = self._resolution
        return x, y, z


def _resolution(extent: np.ndarray[Any, np.dtype[np.float64]], cells: float) -> list[int]:
    """So many cubes along each side; one along sides that are thinner than a cube."""
    active = extent > 0
    size = 1.0
    while active.any():
        # Through logarithms: products of sides might overflow.
        size = float(np.exp((np.log(extent[active]).sum() - np.log(max(cells, 1.0))) / active.sum()))
        thin = active & (extent < size)
        if not thin.any():
            break
        active &= ~thin
    return [int(np.clip(np.round(e / size), 1, _MOST)) if a else 1 for e, a in zip(extent, active, strict=True)]
