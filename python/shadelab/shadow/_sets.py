"""Several maps that share the work of one light."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats

_NONE = 255


@dataclass(frozen=True, eq=False)
class MapSet:
    """Several maps of one light, each for some of the receivers: what cascades, cubes and virtual maps have in common.

    Parameters
    ----------
    maps : tuple of maps
        In the order of their indices.
    border : float
        Texels by which each map reaches beyond the receivers that look into it: filters may be as wide.
    """

    maps: tuple[Any, ...]
    border: float

    @property
    def dtype(self) -> np.dtype[Any]:
        """The precision of lookups."""
        return np.dtype(self.maps[0].dtype)

    @property
    def light_size(self) -> tuple[float, float]:
        """Sides of the light, as of a `ShadowMap`."""
        sides: tuple[float, float] = self.maps[0].light_size
        return sides

    @property
    def projection(self) -> str:
        """As of a `ShadowMap`, and the same for all."""
        return str(self.maps[0].projection)

    @property
    def bytes(self) -> int:
        """What the depths of all maps occupy."""
        return int(sum(m.bytes for m in self.maps))

    def index(self, receivers: ArrayLike) -> NDArray[np.intp]:
        """The map that each receiver looks into: shape (...) of indices into `maps`, -1 where there is none."""
        points = _arrays.vectors("receivers", receivers, 3, self.dtype)
        first = self._chosen(np.ascontiguousarray(points.reshape(-1, 3)))[0].astype(np.intp)
        return np.where(first == _NONE, -1, first).reshape(points.shape[:-1])

    def _chosen(self, points: Floats) -> tuple[NDArray[np.uint8], NDArray[np.uint8] | None, Floats | None]:
        """For each receiver its map, the next one where both count, and the next one's share; 255 is none."""
        raise NotImplementedError

    def _wide(self, texels: float) -> None:
        """Refuses filters that reach beyond the maps' borders, since what lies there would count as lit."""
        if texels > self.border:
            border = f"{self.border:g} texels; draw the maps with a wider one"
            raise ValueError(f"radius: {texels:g} texels reach beyond the border of {border}")
