"""The rasterisation pipeline: coverage, depth, interpolation, G-buffer."""

from . import buffers, interpolation, pictures, visibility
from ._arguments import MAX_SIZE as MAX_SIZE
from .buffers import *  # noqa: F403
from .interpolation import *  # noqa: F403
from .pictures import *  # noqa: F403
from .visibility import *  # noqa: F403

__all__: list[str] = []
__all__ += buffers.__all__
__all__ += interpolation.__all__
__all__ += pictures.__all__
__all__ += visibility.__all__
