"""Generators, sequences and point sets, how even they are, and warps with their densities."""

from . import (
    cones,
    densities,
    diagnostics,
    directions,
    evenness,
    finite_chains,
    generators,
    heuristics,
    markov,
    monte_carlo,
    products,
    sequences,
    sets,
    tabulated,
    warps,
)
from .cones import *  # noqa: F403
from .densities import *  # noqa: F403
from .diagnostics import *  # noqa: F403
from .directions import *  # noqa: F403
from .evenness import *  # noqa: F403
from .finite_chains import *  # noqa: F403
from .generators import *  # noqa: F403
from .heuristics import *  # noqa: F403
from .markov import *  # noqa: F403
from .monte_carlo import *  # noqa: F403
from .products import *  # noqa: F403
from .sequences import *  # noqa: F403
from .sets import *  # noqa: F403
from .tabulated import *  # noqa: F403
from .warps import *  # noqa: F403
from .warps import DiskMethod as DiskMethod
from .warps import TriangleMethod as TriangleMethod

__all__: list[str] = []
__all__ += cones.__all__
__all__ += diagnostics.__all__
__all__ += finite_chains.__all__
__all__ += heuristics.__all__
__all__ += products.__all__
__all__ += densities.__all__
__all__ += directions.__all__
__all__ += evenness.__all__
__all__ += generators.__all__
__all__ += markov.__all__
__all__ += monte_carlo.__all__
__all__ += sequences.__all__
__all__ += sets.__all__
__all__ += tabulated.__all__
__all__ += warps.__all__
