"""Rays, lines and points against primitives; overlap tests; frusta; clipping; bounds.

Overlap tests give the answer of exact arithmetic on the numbers given: what touches overlaps, in one point as well as
in many, and rounding never decides. Ordinary cases cost tens of nanoseconds to a few hundred; cases that double
precision cannot settle are settled without rounding, and cost up to a few microseconds. Magnitudes within 1e-50 and
1e50 (all of float32) are exact throughout; beyond, products overflow or vanish, and what cannot be told counts as
overlap.
"""

from . import (
    bounds,
    boxes,
    clip,
    frustum,
    implicit,
    lines,
    octahedral,
    planes,
    points,
    polygons,
    ray_boxes,
    rays,
    spheres,
    triangles,
)
from .bounds import *  # noqa: F403
from .boxes import *  # noqa: F403
from .clip import *  # noqa: F403
from .frustum import *  # noqa: F403
from .implicit import *  # noqa: F403
from .lines import *  # noqa: F403
from .octahedral import *  # noqa: F403
from .planes import *  # noqa: F403
from .points import *  # noqa: F403
from .polygons import *  # noqa: F403
from .ray_boxes import *  # noqa: F403
from .rays import *  # noqa: F403
from .spheres import *  # noqa: F403
from .triangles import *  # noqa: F403

__all__: list[str] = []
__all__ += bounds.__all__
__all__ += boxes.__all__
__all__ += clip.__all__
__all__ += frustum.__all__
__all__ += implicit.__all__
__all__ += lines.__all__
__all__ += octahedral.__all__
__all__ += planes.__all__
__all__ += points.__all__
__all__ += polygons.__all__
__all__ += ray_boxes.__all__
__all__ += rays.__all__
__all__ += spheres.__all__
__all__ += triangles.__all__
