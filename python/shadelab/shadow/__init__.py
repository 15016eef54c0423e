"""Shadow maps and their filters: every function returns the lit fraction of a light, in [0, 1].

A `ShadowMap` holds the depth of a scene as a light sees it, linear along the light's axis. `hard` compares once, `pcf`
averages comparisons over a fixed width, `pcss` over the width that the blockers call for; `ray_traced` needs no map.
"""

from . import compared, costs, maps, rays, soft
from .compared import *  # noqa: F403
from .costs import *  # noqa: F403
from .maps import *  # noqa: F403
from .maps import _unit as _unit
from .rays import *  # noqa: F403
from .soft import *  # noqa: F403

__all__: list[str] = []
__all__ += compared.__all__
__all__ += costs.__all__
__all__ += maps.__all__
__all__ += rays.__all__
__all__ += soft.__all__
