"""The two workflows of real-time materials, and the way between them."""

from __future__ import annotations

from typing import NamedTuple

from numpy.typing import ArrayLike

from .. import _arrays
from .._arrays import Floats
from .._kernels import brdf as _kernels

__all__ = ["Metallic", "Specular", "to_metallic_roughness", "to_specular_glossiness"]


class Metallic(NamedTuple):
    """Of the metallic-roughness workflow."""

    base_color: Floats
    """(..., 3)"""
    metallic: Floats


class Specular(NamedTuple):
    """Of the specular-glossiness workflow."""

    diffuse: Floats
    """(..., 3)"""
    specular: Floats
    """(..., 3)"""


def to_metallic_roughness(diffuse: ArrayLike, specular: ArrayLike) -> Metallic:
    """Base colour and metallic that come nearest to a diffuse and a specular colour.

    Parameters
    ----------
    diffuse, specular : array_like, shape (..., 3)
        Linear, in [0, 1].

    Returns
    -------
    Metallic
        The roughness is one less the glossiness.

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit.

    Notes
    -----
    Metals and dielectrics of 4 % come out as they went in; coloured or strong specular over a diffuse colour has no
    equal in this workflow, and comes out by brightness.

    References
    ----------
    Khronos, *KHR_materials_pbrSpecularGlossiness*, 2017, appendix.

    Examples
    --------
    >>> to_metallic_roughness([0.0, 0.0, 0.0], [0.9, 0.6, 0.3])
    Metallic(base_color=array([0.9, 0.6, 0.3]), metallic=array(1.))
    """
    given: dict[str, tuple[ArrayLike, int]] = {"diffuse": (diffuse, 3), "specular": (specular, 3)}
    return Metallic(*_arrays.elementwise(_kernels.to_metallic_roughness, given, [3, 0]))


def to_specular_glossiness(base_color: ArrayLike, metallic: ArrayLike) -> Specular:
    """Diffuse and specular colours of a base colour and metallic.

    Parameters
    ----------
    base_color : array_like, shape (..., 3)
        Linear, in [0, 1].
    metallic : array_like
        In [0, 1].

    Returns
    -------
    Specular
        The glossiness is one less the roughness.

    Raises
    ------
    TypeError, ValueError
        If shapes do not fit.

    References
    ----------
    Khronos, *KHR_materials_pbrSpecularGlossiness*, 2017, appendix.

    Examples
    --------
    >>> to_specular_glossiness([0.9, 0.6, 0.3], 0.0).specular
    array([0.04, 0.04, 0.04])
    """
    given: dict[str, tuple[ArrayLike, int]] = {"base_color": (base_color, 3)}
    found = _arrays.elementwise(_kernels.to_specular_glossiness, given, [3, 3], knobs={"metallic": metallic})
    return Specular(*found)
