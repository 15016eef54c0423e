"""Punctual and area lights: irradiance in closed form, sampling, unshadowed radiance."""

from . import choice, draws, kinds, received, reflected
from .choice import *  # noqa: F403
from .draws import *  # noqa: F403
from .kinds import *  # noqa: F403
from .kinds import Light as Light
from .kinds import _table as _table
from .received import *  # noqa: F403
from .reflected import *  # noqa: F403
from .reflected import _receivers as _receivers

__all__: list[str] = []
__all__ += choice.__all__
__all__ += draws.__all__
__all__ += kinds.__all__
__all__ += received.__all__
__all__ += reflected.__all__
