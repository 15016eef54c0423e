"""Reflection models: evaluation, sampling, density.

Directions are unit vectors that leave the surface, in the local frame whose z is the normal: `wi` to the light, `wo`
to the eye. Values are BRDFs in sr⁻¹, without the cosine; densities are per solid angle of `wi`.

Microfacet models are `RoughConductor`, `RoughDielectric`, `MetallicRoughness`, `SpecularGlossiness` and `Principled`;
`ndf`, `masking_shadowing` and `fresnel` are their factors, which ``eval(wi, wo, full_output=True)`` gives. Sheen
and clearcoat are parameters of `Principled`; `Plastic` is a diffuser under a smooth coat. Energy compensation is
``compensation=`` of the rough models, by `kulla_conty` and `albedo_table`; `white_furnace` measures what they lose.
"""

from ._model import Draws, Model, Terms
from .artists import *  # noqa: F403
from .artists import __all__ as _artists
from .diffusers import *  # noqa: F403
from .diffusers import __all__ as _diffusers
from .facets import *  # noqa: F403
from .facets import __all__ as _facets
from .furnace import *  # noqa: F403
from .furnace import __all__ as _furnace
from .glasses import *  # noqa: F403
from .glasses import __all__ as _glasses
from .highlights import *  # noqa: F403
from .highlights import __all__ as _highlights
from .interface import *  # noqa: F403
from .interface import __all__ as _interface
from .metallic import *  # noqa: F403
from .metallic import __all__ as _metallic
from .metals import *  # noqa: F403
from .metals import __all__ as _metals
from .mirrors import *  # noqa: F403
from .mirrors import __all__ as _mirrors
from .workflow import *  # noqa: F403
from .workflow import __all__ as _workflow

__all__: list[str] = ["Draws", "Model", "Terms"]
__all__ += _facets
__all__ += _furnace
__all__ += _interface
__all__ += _metallic
__all__ += _mirrors
__all__ += _artists
__all__ += _diffusers
__all__ += _glasses
__all__ += _highlights
__all__ += _metals
__all__ += _workflow
