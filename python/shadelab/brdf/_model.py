"""What all reflection models share: parameters that may be arrays, value, density, draws, and the row for kernels."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar, Literal, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import brdf as _kernels

__all__ = ["Draws", "Model", "Terms"]

ROW: int = _kernels.row_width()


def parameter(
    default: Any, core: int = 0, low: float = -math.inf, high: float = math.inf, *, above: float | None = None
) -> Any:
    """A number (core 0) or a triple (core 3) in [low, high], and above `above` if given; or an array of them."""
    return field(default=default, metadata={"core": core, "low": low, "high": high, "above": above})


def color(default: Any, high: float = 1.0) -> Any:
    """A linear colour in [0, high]."""
    return parameter(default, 3, 0.0, high)


def option(default: str, choices: tuple[str, ...]) -> Any:
    """A name of several."""
    return field(default=default, metadata={"choices": choices})


class Draws(NamedTuple):
    """Directions to the light, drawn for directions to the eye."""

    wi: Floats
    """Unit directions, shape (..., 3)."""
    weight: Floats
    """Value times |cosine| over density, shape (..., 3); zero where nothing comes back."""
    pdf: Floats
    """Per solid angle of `wi`; of a specular draw its chance."""
    specular: NDArray[np.bool_]
    """Whether it is one of finitely many directions: a mirror's, a smooth interface's."""
    eta: Floats
    """Index of refraction on the side of `wi` over that on the side of `wo`: one unless the draw crosses."""


class Terms(NamedTuple):
    """The factors of a microfacet model, value = D F G / (4 cos θi cos θo)."""

    value: Floats
    """The BRDF in sr⁻¹ with all its parts, shape (..., 3)."""
    half: Floats
    """Unit half vectors, shape (..., 3)."""
    distribution: Floats
    """D: density of facets' normals at the half vector."""
    fresnel: Floats
    """F: reflectance of a facet, shape (..., 3)."""
    masking: Floats
    """G: share of facets that both directions see; zero across the horizon."""


@dataclass(frozen=True)
class Model:
    """A reflection model: what `eval`, `pdf` and `sample` mean for all of them.

    Directions are unit vectors that leave the surface, in the local frame whose z is the normal: `wi` to the light,
    `wo` to the eye. Opaque models reflect above the horizon alone; those that transmit take directions on both sides, z
    pointing out of the body. Every parameter is a number (or colour) or an array of them; leading axes of parameters
    and directions broadcast. A lone number out of its domain is a ValueError; an element of an array out of it gives
    NaN there. Arrays decide the precision, lone numbers do not.
    """

    _kind: ClassVar[int]
    _transmits: ClassVar[bool] = False
    _facets: ClassVar[bool] = False

    def __post_init__(self) -> None:
        for f in fields(self):
            value, meta = getattr(self, f.name), f.metadata
            if "choices" in meta:
                _arrays.choice(f.name, value, meta["choices"])
            elif meta:
                object.__setattr__(self, f.name, _coerced(f.name, value, meta))

    def _numbers(self) -> list[Any]:
        """The row's numbers in order: of each a number, a triple, or an array of them with the core it has."""
        return [(value, meta) for value, meta in self._parameters()]

    def _number(self) -> int:
        """The kind as kernels count it."""
        return self._kind

    def _parameters(self) -> list[tuple[Any, Any]]:
        return [(getattr(self, f.name), f.metadata) for f in fields(self) if f.metadata]

    def _table(self, dtype: DTypeLike) -> Floats:
        """The rows of all parameters together, shape (..., ROW); elements out of their domain are NaN."""
        columns: list[tuple[Floats, int]] = []
        for value, meta in self._numbers():
            if "choices" in meta:
                columns.append((np.asarray(meta["choices"].index(value), dtype), 0))
                continue
            array = np.asarray(value, dtype)
            bad = ~((array >= meta["low"]) & (array <= meta["high"]))
            if meta["above"] is not None:
                bad |= ~(array > meta["above"])
            columns.append((np.where(bad, np.asarray(np.nan, dtype), array), meta["core"]))
        try:
            lead = np.broadcast_shapes(*(a.shape[: a.ndim - (core > 0)] for a, core in columns))
        except ValueError:
            shapes = ", ".join(str(a.shape) for a, _ in columns)
            raise ValueError(f"parameters: shapes {shapes} do not broadcast") from None
        rows = np.zeros((*lead, ROW), dtype)
        at = 0
        for array, core in columns:
            width = core or 1
            rows[..., at : at + width] = array if core else array[..., None]
            at += width
        return rows

    def _given(self, **directions: ArrayLike) -> tuple[tuple[int, ...], list[Floats], tuple[int, Floats, Any]]:
        """The batch's shape, directions (n, 3), and what kernels know of the parameters."""
        batched = {f.name: v for f in fields(self) if isinstance(v := getattr(self, f.name), np.ndarray)}
        dtype = _arrays.result_dtype(**directions, **batched)
        core = {name: (_arrays.vectors(name, value, 3, dtype), 1) for name, value in directions.items()}
        rows = self._table(dtype)
        lead = rows.shape[:-1]
        size = math.prod(lead)
        if size == 1:
            shape, flat = _arrays.broadcast(core)
            return np.broadcast_shapes(lead, shape), flat, (self._number(), rows.reshape(1, ROW), None)
        number = np.arange(size, dtype=dtype).reshape(lead)
        shape, (*flat, _) = _arrays.broadcast(core | {"parameters": (number, 0)})
        ids = np.ascontiguousarray(np.broadcast_to(np.arange(size, dtype=np.int32).reshape(lead), shape)).reshape(-1)
        return shape, flat, (self._number(), rows.reshape(-1, ROW), None if size == len(ids) else ids)

    def _row(self) -> Floats:
        """The row of a model whose parameters are lone numbers: what a scene holds."""
        for f in fields(self):
            if isinstance(getattr(self, f.name), np.ndarray):
                raise ValueError(f"{f.name}: expected one value for a material of a scene, got an array")
        return self._table(np.float64)

    def _stand_in(self) -> Any:
        """The metallic-roughness material that comes nearest: what shading without this model shows."""
        raise NotImplementedError

    @overload
    def eval(
        self, wi: ArrayLike, wo: ArrayLike, *, out: Floats | None = ..., full_output: Literal[False] = ...
    ) -> Floats: ...
    @overload
    def eval(self, wi: ArrayLike, wo: ArrayLike, *, out: Floats | None = ..., full_output: Literal[True]) -> Terms: ...
    def eval(
        self, wi: ArrayLike, wo: ArrayLike, *, out: Floats | None = None, full_output: bool = False
    ) -> Floats | Terms:
        """The BSDF in sr⁻¹, without the cosine.

        Parameters
        ----------
        wi, wo : array_like, shape (..., 3)
            Unit directions to the light and to the eye, z the normal.
        out : ndarray, optional
            To write into.
        full_output : bool
            Give `Terms`, of models of facets: half vectors, D, F, G.

        Returns
        -------
        ndarray, shape (..., 3), or Terms
            Zero where nothing is reflected or transmitted, and of models that are specular.

        Raises
        ------
        TypeError, ValueError
            If shapes do not fit, or `out` does not, or terms are asked of a model that has none.

        Examples
        --------
        >>> from shadelab import brdf
        >>> brdf.Diffuse((1.0, 0.5, 0.0)).eval([0, 0.6, 0.8], [0, 0, 1]).round(4)
        array([0.3183, 0.1592, 0.    ])
        """
        shape, (wi, wo), table = self._given(wi=wi, wo=wo)
        out = _arrays.output("out", out, (*shape, 3), wi.dtype)
        _kernels.model_eval(table, wi, wo, out.reshape(-1, 3))
        if not _arrays.flag("full_output", full_output):
            return out
        if not self._facets:
            raise ValueError(f"full_output: {type(self).__name__} is no model of facets")
        n, dtype = len(wi), wi.dtype
        terms = [np.empty(s, dtype) for s in ((n, 3), n, (n, 3), n)]
        _kernels.model_terms(table, wi, wo, terms)
        half, distribution, fresnel, masking = (t.reshape((*shape, *t.shape[1:])) for t in terms)
        return Terms(out, half, distribution, fresnel, masking)

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """The density of `sample` per solid angle of `wi`.

        Parameters
        ----------
        wi, wo : array_like, shape (..., 3)
            Unit directions to the light and to the eye, z the normal.

        Returns
        -------
        ndarray, shape (...)
            Without specular draws.

        Raises
        ------
        TypeError, ValueError
            If shapes do not fit.
        """
        shape, (wi, wo), table = self._given(wi=wi, wo=wo)
        out = np.empty(len(wi), wi.dtype)
        _kernels.model_pdf(table, wi, wo, out)
        return out.reshape(shape)

    def sample(self, wo: ArrayLike, u: ArrayLike) -> Draws:
        """Directions to the light, about in proportion to what they bring.

        Parameters
        ----------
        wo : array_like, shape (..., 3)
            Unit directions to the eye.
        u : array_like, shape (..., 3)
            In [0, 1): two for the direction, one to choose among parts.

        Returns
        -------
        Draws
            NaN where nothing can come back along `wo`: below the horizon of an opaque model.

        Raises
        ------
        TypeError, ValueError
            If shapes do not fit.
        """
        shape, (wo, u), table = self._given(wo=wo, u=u)
        n, dtype = len(wo), wo.dtype
        out = [
            np.empty((n, 3), dtype),
            np.empty((n, 3), dtype),
            np.empty(n, dtype),
            np.empty(n, bool),
            np.empty(n, dtype),
        ]
        _kernels.model_sample(table, wo, u, out)
        wi, weight, pdf, specular, eta = out
        columns = (wi.reshape(*shape, 3), weight.reshape(*shape, 3), pdf.reshape(shape))
        return Draws(*columns, specular.reshape(shape), eta.reshape(shape))


def _coerced(name: str, value: Any, meta: Any) -> Any:
    """A float or a triple of floats in its domain, or a read-only array of either."""
    core = meta["core"]
    if isinstance(value, list | tuple) and not core:
        value = _arrays.floats(name, value)
    if isinstance(value, np.ndarray) and value.ndim > (1 if core else 0):
        array = (_arrays.vectors(name, value, core) if core else _arrays.floats(name, value)).copy()
        array.flags.writeable = False
        return array

    def one(x: Any) -> float:
        return _arrays.number(name, x, meta["low"], meta["high"], above=meta["above"])

    if not core:
        return one(value)
    if np.ndim(_arrays.array(name, value)) == 0:
        return (one(value),) * 3
    if np.shape(value) != (core,):
        if np.ndim(value) > 1:
            return _coerced(name, np.asarray(value, np.float64), meta)
        raise ValueError(f"{name}: expected three numbers, got {value!r}")
    return tuple(one(x) for x in value)
