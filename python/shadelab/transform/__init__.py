"""Model, view, projection, viewport: matrices that act on column vectors, and their work on points.

Right-handed, y up; cameras look down -z. Functions that make matrices broadcast their arguments and give
`(..., 4, 4)`, in the plane `(..., 3, 3)`; compose with `@`. Matrices made from Python numbers are double; applied to
float32 points they are rounded once, and the points' precision governs.
"""

from . import affine, points, projection, quaternion, rotation, vectors, view
from .affine import *  # noqa: F403
from .points import *  # noqa: F403
from .projection import *  # noqa: F403
from .quaternion import *  # noqa: F403
from .rotation import *  # noqa: F403
from .vectors import *  # noqa: F403
from .view import *  # noqa: F403

__all__: list[str] = []
__all__ += affine.__all__
__all__ += points.__all__
__all__ += projection.__all__
__all__ += quaternion.__all__
__all__ += rotation.__all__
__all__ += vectors.__all__
__all__ += view.__all__
