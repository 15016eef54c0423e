"""Generators, sequences, and warps with their densities."""

from . import directions, generators, sequences, tabulated, warps
from .directions import *  # noqa: F403
from .generators import *  # noqa: F403
from .sequences import *  # noqa: F403
from .tabulated import *  # noqa: F403
from .warps import *  # noqa: F403
from .warps import DiskMethod as DiskMethod
from .warps import TriangleMethod as TriangleMethod

__all__: list[str] = []
__all__ += directions.__all__
__all__ += generators.__all__
__all__ += sequences.__all__
__all__ += tabulated.__all__
__all__ += warps.__all__
