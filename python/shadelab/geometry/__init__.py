"""Rays, lines and points against primitives; overlap tests; frusta; clipping; bounds."""

from . import bounds, clip, frustum, implicit, lines, octahedral, overlap, points, polygons, ray_boxes, rays
from .bounds import *  # noqa: F403
from .clip import *  # noqa: F403
from .frustum import *  # noqa: F403
from .implicit import *  # noqa: F403
from .lines import *  # noqa: F403
from .octahedral import *  # noqa: F403
from .overlap import *  # noqa: F403
from .points import *  # noqa: F403
from .polygons import *  # noqa: F403
from .ray_boxes import *  # noqa: F403
from .rays import *  # noqa: F403

__all__: list[str] = []
__all__ += bounds.__all__
__all__ += clip.__all__
__all__ += frustum.__all__
__all__ += implicit.__all__
__all__ += lines.__all__
__all__ += octahedral.__all__
__all__ += overlap.__all__
__all__ += points.__all__
__all__ += polygons.__all__
__all__ += ray_boxes.__all__
__all__ += rays.__all__
