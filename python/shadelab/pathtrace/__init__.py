"""Ray casting, direct light, path tracing: the references, each with its own error."""

from . import aov, cameras, casting, direct, filters, paths, recursive, spectra
from .aov import *  # noqa: F403
from .cameras import *  # noqa: F403
from .casting import *  # noqa: F403
from .direct import *  # noqa: F403
from .filters import *  # noqa: F403
from .paths import *  # noqa: F403
from .recursive import *  # noqa: F403
from .spectra import *  # noqa: F403

__all__: list[str] = []
__all__ += aov.__all__
__all__ += cameras.__all__
__all__ += casting.__all__
__all__ += direct.__all__
__all__ += filters.__all__
__all__ += paths.__all__
__all__ += recursive.__all__
__all__ += spectra.__all__
