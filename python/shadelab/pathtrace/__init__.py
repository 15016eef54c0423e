"""Ray casting, direct light, path tracing: the references, each with its own error."""

from . import casting, direct, paths
from .casting import *  # noqa: F403
from .direct import *  # noqa: F403
from .paths import *  # noqa: F403

__all__: list[str] = []
__all__ += casting.__all__
__all__ += direct.__all__
__all__ += paths.__all__
