"""From a scene to a picture through the shortest list of passes, each with its reason.

`plan` looks at what a scene holds and decides which passes it requires; `render` runs them. Both also stand at the top:
`shadelab.plan`, `shadelab.render`.
"""

from . import frames, passes, pictures, plans, shading
from .frames import *  # noqa: F403
from .passes import *  # noqa: F403
from .pictures import *  # noqa: F403
from .plans import *  # noqa: F403
from .shading import *  # noqa: F403

__all__: list[str] = []
__all__ += frames.__all__
__all__ += passes.__all__
__all__ += pictures.__all__
__all__ += plans.__all__
__all__ += shading.__all__
