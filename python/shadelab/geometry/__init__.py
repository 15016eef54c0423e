"""Rays against primitives, and barycentric coordinates."""

from . import points, rays
from .points import *  # noqa: F403
from .rays import *  # noqa: F403

__all__: list[str] = []
__all__ += points.__all__
__all__ += rays.__all__
