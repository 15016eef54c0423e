"""Rays against primitives, overlap tests, and barycentric coordinates."""

from . import overlap, points, rays
from .overlap import *  # noqa: F403
from .points import *  # noqa: F403
from .rays import *  # noqa: F403

__all__: list[str] = []
__all__ += overlap.__all__
__all__ += points.__all__
__all__ += rays.__all__
