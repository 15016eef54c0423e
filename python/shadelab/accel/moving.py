"""The hierarchy moved, copied, saved, and met by boxes."""

from __future__ import annotations

import time
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import accel as _kernels
from ._rays import Progress, mesh_arrays

__all__ = ["Overlaps"]


class Overlaps(NamedTuple):
    """The faces that overlap each of some boxes, one box after the other; each one's in rising order."""

    offsets: NDArray[np.int64]
    """Where each box's faces begin, and where the last one's end: (boxes + 1,). Boxes count in the batch's C order."""
    face: NDArray[np.int32]

    @property
    def box(self) -> NDArray[np.int64]:
        """The index of each face's box in the flattened batch."""
        return np.repeat(np.arange(len(self.offsets) - 1), np.diff(self.offsets))


class Movable:
    """What `BVH` does beside answering rays and points."""

    _tree: Any
    _positions: Floats
    _faces: NDArray[np.int32]
    _build_ms: float

    def overlap(self, lower: ArrayLike, upper: ArrayLike, *, progress: Progress = None) -> Overlaps:
        """Find the faces that overlap axis-aligned boxes.

        Parameters
        ----------
        lower, upper : array_like, shape (..., 3)
            Corners of boxes, converted to the structure's precision; leading axes broadcast.
        progress : bool or callable, optional
            True for a bar, or called with (done, total).

        Returns
        -------
        Overlaps
            The faces of all boxes; those of box `i` stand at `offsets[i]:offsets[i + 1]`.

        Raises
        ------
        TypeError, ValueError
            If an argument is not real, not of its shape, or does not broadcast.
        MemoryError
            If there is no memory for all faces.

        Notes
        -----
        The triangles themselves are tested, not their boxes: by all thirteen axes, exactly (see
        `shadelab.geometry.triangle_aabb`). Touching counts. A box with NaN, or whose `lower` exceeds its `upper`,
        overlaps nothing; infinite boxes are as good as others.

        Examples
        --------
        >>> import shadelab as sl
        >>> bvh = sl.accel.BVH([[0.0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> bvh.overlap([[1, 1, -1], [3, 3, -1]], [[2, 2, 1], [4, 4, 1]]).offsets
        array([0, 1, 1])
        """
        dtype = self._positions.dtype
        given: dict[str, tuple[Floats, int]] = {
            "lower": (_arrays.vectors("lower", lower, 3, dtype), 1),
            "upper": (_arrays.vectors("upper", upper, 3, dtype), 1),
        }
        _, flat = _arrays.broadcast(given)
        # Infinite boxes reach beyond every vertex at the largest number.
        most = np.finfo(dtype).max
        bounds = [np.clip(x, -most, most) for x in flat]
        return Overlaps(*_kernels.overlap(self._tree, *bounds, _arrays.progress_callback(progress, "overlap")))

    def refit(self, positions: ArrayLike) -> Self:
        """A hierarchy over the same faces after their vertices moved: cheaper than a new one, and as right.

        Parameters
        ----------
        positions : array_like, shape (V, 3)
            Where the vertices are now, converted to the structure's precision.

        Returns
        -------
        BVH
            A new one; this one stays as it is, and may answer other threads meanwhile.

        Raises
        ------
        TypeError, ValueError
            If the vertices are not as many as before, or as `BVH` does.

        Notes
        -----
        Which triangles stand together stays, boxes are fitted anew: answers equal `brute_force` on the moved mesh to
        the bit, but rays cost more the farther triangles that stood together have moved apart. `stats().sah_cost`
        tells: build anew where it has doubled. Takes a third of a build by SAH; `stats().build_ms` is the refit's time.

        Examples
        --------
        >>> import shadelab as sl
        >>> ball = sl.mesh.icosphere(2)
        >>> bvh = sl.accel.BVH(ball.positions, ball.faces)
        >>> moved = bvh.refit(ball.positions * [1.0, 2.0, 1.0])
        >>> float(moved.closest_hit([0, 9, 0], [0, -1, 0]).t)
        7.0
        """
        given = _arrays.vectors("positions", positions, 3, self._positions.dtype)
        if given.shape != self._positions.shape:
            raise ValueError(f"positions: expected shape {self._positions.shape}, got {given.shape}")
        p, f = mesh_arrays(given, self._faces)
        start = time.perf_counter()
        tree = _kernels.refit(self._tree, p, f)
        return self._with(p.copy(), tree, (time.perf_counter() - start) * 1e3)

    def _with(self, positions: Floats, tree: Any, build_ms: float) -> Self:
        other = type(self).__new__(type(self))
        other._positions, other._faces, other._tree, other._build_ms = positions, self._faces, tree, build_ms
        other._positions.flags.writeable = False
        return other

    def __copy__(self) -> Self:
        return self._with(self._positions, self._tree, self._build_ms)

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        # Nothing in it ever changes.
        return self.__copy__()

    def __getstate__(self) -> dict[str, Any]:
        # What is computed when it is first asked for is left out, and boxes follow from the mesh.
        tree = _kernels.to_bytes(self._tree)
        return {"positions": self._positions, "faces": self._faces, "tree": tree, "build_ms": self._build_ms}

    def __setstate__(self, state: dict[str, Any]) -> None:
        missing = {"positions", "faces", "tree", "build_ms"} - set(state)
        if missing:
            raise ValueError(f"the saved {type(self).__name__} lacks {', '.join(sorted(missing))}")
        p, f = mesh_arrays(state["positions"], state["faces"])
        self._tree = _kernels.from_bytes(state["tree"], p, f)
        self._positions, self._faces, self._build_ms = p.copy(), f.copy(), float(state["build_ms"])
        self._positions.flags.writeable = self._faces.flags.writeable = False
