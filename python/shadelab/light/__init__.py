"""Punctual and area lights: irradiance in closed form, sampling, transformed cosines, unshadowed radiance, units."""

from . import angles, choice, draws, kinds, received, reflected, transformed, units
from .angles import *  # noqa: F403
from .choice import *  # noqa: F403
from .draws import *  # noqa: F403
from .kinds import *  # noqa: F403
from .kinds import Light as Light
from .kinds import _table as _table
from .received import *  # noqa: F403
from .reflected import *  # noqa: F403
from .reflected import _receivers as _receivers
from .transformed import *  # noqa: F403
from .units import *  # noqa: F403

__all__: list[str] = []
__all__ += angles.__all__
__all__ += choice.__all__
__all__ += draws.__all__
__all__ += kinds.__all__
__all__ += received.__all__
__all__ += reflected.__all__
__all__ += transformed.__all__
__all__ += units.__all__
