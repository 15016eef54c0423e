"""Kinds of light: what each radiates, and where; and several of them as the kernels take them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, TypeAlias

import numpy as np

from .punctual import AmbientLight, DirectionalLight, PointLight, SpotLight
from .rectangle import RectLight
from .shapes import DiskLight, PolygonLight, SphereLight

__all__ = [
    "AmbientLight",
    "DirectionalLight",
    "DiskLight",
    "PointLight",
    "PolygonLight",
    "RectLight",
    "SphereLight",
    "SpotLight",
]

Light: TypeAlias = (
    PointLight | SpotLight | DirectionalLight | RectLight | DiskLight | SphereLight | PolygonLight | AmbientLight
)
AreaLight: TypeAlias = RectLight | DiskLight | SphereLight | PolygonLight | AmbientLight


def _several(name: str, lights: Light | Iterable[Light]) -> list[Light]:
    """One light or many, as a list."""
    try:
        several = [lights] if isinstance(lights, Light) else list(lights)
    except TypeError:
        raise TypeError(f"{name}: expected a light or lights, got {type(lights).__name__}") from None
    for light in several:
        if not isinstance(light, Light):
            raise TypeError(f"{name}: expected a light or lights, got {type(light).__name__}")
    return several


def _table(name: str, lights: Light | Sequence[Light]) -> Any:
    """Lights as numbers for the kernels: the kind of each, how many numbers follow, and these.

    With what gives the pictures of those that show some, in order.
    """
    several = _several(name, lights)
    numbers = np.array([x for light in several for x in light._row()], np.float64)
    shown = [light._shown for light in several if isinstance(light, RectLight) and light.texture is not None]
    return (numbers, shown) if shown else numbers


def area_table(light: AreaLight) -> Any:
    """One light that has an area."""
    if not isinstance(light, AreaLight):
        raise TypeError(f"light: expected a light with an area, got {type(light).__name__}")
    return _table("light", light)
