"""Which of many lights to draw from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import light as _kernels
from .kinds import Light, _several, _table

__all__ = ["LightChoice", "LightSelection"]

_METHODS = ("tree", "power", "uniform")


class LightChoice(NamedTuple):
    """Lights drawn for points."""

    light: NDArray[np.int32]
    """Their indices; -1 where no light may shine."""
    probability: Floats
    """Of having drawn that light; zero where there is none."""


class LightSelection:
    """Choose lights at random in proportion to what they may bring to a point.

    Parameters
    ----------
    lights : light or sequence of lights
    method : {"tree", "power", "uniform"}
        By a tree of bounds on place, orientation and power; by power alone; or evenly.
    scene_radius : float
        Of the scene that lights without a place (directional, ambient) shine on: gives them a power.

    Raises
    ------
    TypeError, ValueError
        If something is no light, or the method unknown.

    Notes
    -----
    The tree never draws a light that turns away from the point, that lies wholly below the horizon of a given normal,
    or that has no power; those without a place are each as likely as all others together. Its cost grows with the
    logarithm of the number of lights.

    References
    ----------
    A. Conty Estevez, C. Kulla, *Importance sampling of many lights with adaptive tree splitting*, 2018.

    Examples
    --------
    >>> from shadelab.light import PointLight
    >>> near, far = PointLight((0, 1, 0)), PointLight((0, 3, 0))
    >>> LightSelection([near, far]).probability([0.0, 0, 0], [0, 1])
    array([0.9, 0.1])
    """

    def __init__(self, lights: Light | Sequence[Light], method: str = "tree", *, scene_radius: float = 1.0) -> None:
        several = _several("lights", lights)
        packed = _table("lights", several)
        self._count = len(several)
        self._method = _arrays.choice("method", method, _METHODS)
        radius = _arrays.number("scene_radius", scene_radius, 0)
        self._chooser = _kernels.chooser(packed, self._method, radius)

    def __len__(self) -> int:
        return self._count

    def __repr__(self) -> str:
        return f"LightSelection({self._count} lights, method={self._method!r})"

    def draw(self, points: ArrayLike, u: ArrayLike, normals: ArrayLike | None = None) -> LightChoice:
        """Draw a light for every point.

        Parameters
        ----------
        points : array_like, shape (..., 3)
        u : array_like, shape (...)
            In [0, 1).
        normals : array_like, shape (..., 3), optional
            Unit, of surfaces whose upper side is lit.

        Returns
        -------
        LightChoice

        Raises
        ------
        TypeError, ValueError
            If an argument is not real or of the wrong shape.
        """
        dtype = _arrays.result_dtype(points=points, u=u, normals=normals)
        shape, flat = self._flat(points, normals, dtype, "u", _arrays.floats("u", u, dtype))
        light, chance = np.empty(shape, np.int32), np.empty(shape, dtype)
        _kernels.choose(self._chooser, flat, (light.reshape(-1), chance.reshape(-1)))
        return LightChoice(light, chance)

    def probability(self, points: ArrayLike, light: ArrayLike, normals: ArrayLike | None = None) -> Floats:
        """The probability with which `draw` gives a light.

        Parameters
        ----------
        points : array_like, shape (..., 3)
        light : array_like of int, shape (...)
            Indices of lights.
        normals : array_like, shape (..., 3), optional

        Returns
        -------
        ndarray, shape (...)

        Raises
        ------
        TypeError, ValueError
            If an argument is of the wrong kind or shape, or an index out of range.
        """
        dtype = _arrays.result_dtype(points=points, normals=normals)
        ids = _arrays.indices("light", light, below=self._count)
        shape, flat = self._flat(points, normals, dtype, "light", ids)
        chance = np.empty(shape, dtype)
        _kernels.chance(self._chooser, flat, chance.reshape(-1))
        return chance

    def _flat(
        self, points: ArrayLike, normals: ArrayLike | None, dtype: np.dtype[Any], name: str, last: NDArray[Any]
    ) -> tuple[tuple[int, ...], list[NDArray[Any]]]:
        core = {"points": (_arrays.vectors("points", points, 3, dtype), 1)}
        given = np.zeros(3, dtype) if normals is None else normals
        core["normals"] = (_arrays.vectors("normals", given, 3, dtype), 1)
        core[name] = (last, 0)
        return _arrays.broadcast(core)
