"""Shadow maps and their filters: every function returns the lit fraction of a light, in [0, 1].

A `ShadowMap` holds the depth of a scene as a light sees it, linear along the light's axis. `hard` compares once, `pcf`
averages comparisons over a fixed width, `pcss` over the width that the blockers call for; `ray_traced` needs no map,
`distance_field` asks how far things are, and `half_plane` is exact.
A `MomentMap` holds means of powers or exponentials of depth, which are filtered before the lookup: `variance`,
`exponential_variance` and `moment` read one texel whatever the width, `variance_soft` two.

Several maps that share the work are looked up as one: `cube_shadow_map` around a point light, `cascades` along a long
view under the sun, `virtual_shadow_map` for the pages of a map that is too large to be held.
"""

from . import (
    bounds,
    cascaded,
    closed,
    compared,
    costs,
    cubes,
    fields,
    filtered,
    filtered_soft,
    grids,
    maps,
    measures,
    moments,
    rays,
    soft,
    virtual,
)
from ._sets import MapSet as MapSet
from .bounds import *  # noqa: F403
from .cascaded import *  # noqa: F403
from .closed import *  # noqa: F403
from .compared import *  # noqa: F403
from .costs import *  # noqa: F403
from .cubes import *  # noqa: F403
from .fields import *  # noqa: F403
from .filtered import *  # noqa: F403
from .filtered_soft import *  # noqa: F403
from .grids import *  # noqa: F403
from .maps import *  # noqa: F403
from .maps import _unit as _unit
from .measures import *  # noqa: F403
from .moments import *  # noqa: F403
from .moments import _prepared as _prepared
from .rays import *  # noqa: F403
from .soft import *  # noqa: F403
from .virtual import *  # noqa: F403

__all__: list[str] = []
__all__ += bounds.__all__
__all__ += cascaded.__all__
__all__ += closed.__all__
__all__ += compared.__all__
__all__ += costs.__all__
__all__ += cubes.__all__
__all__ += fields.__all__
__all__ += filtered.__all__
__all__ += filtered_soft.__all__
__all__ += grids.__all__
__all__ += maps.__all__
__all__ += measures.__all__
__all__ += moments.__all__
__all__ += rays.__all__
__all__ += soft.__all__
__all__ += virtual.__all__
