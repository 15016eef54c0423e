"""Acceleration structures for ray queries, and the brute force that they must equal."""

from . import brute, bvh, grid, instances, morton, moving, offset, points, trees
from ._rays import AllHits, Hit
from ._structure import Counts, Stats, Structure
from .brute import *  # noqa: F403
from .bvh import *  # noqa: F403
from .grid import *  # noqa: F403
from .instances import *  # noqa: F403
from .morton import *  # noqa: F403
from .moving import *  # noqa: F403
from .offset import *  # noqa: F403
from .points import *  # noqa: F403
from .trees import *  # noqa: F403

__all__ = ["AllHits", "Counts", "Hit", "Stats", "Structure"]
__all__ += brute.__all__
__all__ += bvh.__all__
__all__ += morton.__all__
__all__ += grid.__all__
__all__ += offset.__all__
__all__ += points.__all__
__all__ += trees.__all__
__all__ += moving.__all__
__all__ += instances.__all__
