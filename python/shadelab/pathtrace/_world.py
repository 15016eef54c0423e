"""A scene as kernels take it: at one time, or at the times at which samples see it while the shutter is open."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .. import _arrays, light
from ..accel import BVH
from ._common import check_bvh, surface_offset
from ._copies import Copies

if TYPE_CHECKING:
    from ..scene import Scene, SceneArrays

# Moments at which moving scenes are traced, in one run, at most.
_MOMENTS = 64


class Moment(NamedTuple):
    """Samples that see the scene alike."""

    start: int
    samples: int
    arrays: SceneArrays
    bvh: BVH
    shutter: tuple[float, float] | None
    """What the camera's own shutter becomes; None leaves it."""


class World:
    """The scene and its hierarchy at time 0, refitted at others."""

    def __init__(
        self,
        scene: Scene,
        bvh: BVH | None,
        dtype: np.dtype[Any],
        all_directions: bool = False,
        shared: Sequence[int] = (),
    ) -> None:
        """With `all_directions`, light that comes evenly from everywhere is background, not a source to be asked.

        The instances in `shared` are traced as copies.
        """
        if not callable(getattr(scene, "flatten", None)) or isinstance(scene, np.ndarray):
            raise TypeError(f"scene: expected a Scene, got {type(scene).__name__}")
        self.scene, self.dtype = scene, dtype
        self.copies = Copies(scene, shared, dtype) if shared else None
        # What is flattened: all but the copies.
        self._rest = self.copies.rest if self.copies else scene
        self.arrays = self._rest.flatten(dtype)
        if bvh is None:
            bvh = BVH(self.arrays.positions, self.arrays.faces)
        else:
            check_bvh(bvh)
            own, mine = (bvh._positions, bvh._faces), (self.arrays.positions, self.arrays.faces)
            if own[0].dtype != dtype or not all(np.array_equal(a, b) for a, b in zip(own, mine, strict=True)):
                raise ValueError(f"bvh: expected one of the flattened scene in {dtype}")
        self.bvh = bvh
        self._all_directions = all_directions
        _arrays.warn_if_coarse(self._with_copies(self.arrays.positions), dtype, 5)

    def _with_copies(self, positions: Any) -> Any:
        """Positions of the rest, and the corners of the boxes of copies."""
        return positions if self.copies is None else np.concatenate([positions, self.copies.corners])

    @cached_property
    def _sources(self) -> tuple[Any, tuple[float, ...], Any]:
        """The lights; the background; the panorama."""
        scene = self.scene
        lights, background, sky = list(scene.lights), np.array(scene.background, float), scene.environment
        if self._all_directions:
            ambient = [lamp for lamp in lights if isinstance(lamp, light.AmbientLight)]
            lights = [lamp for lamp in lights if not isinstance(lamp, light.AmbientLight)]
            for lamp in ambient:
                background += lamp.radiance
            if sky is not None and not np.ptp(sky.radiance, axis=(0, 1)).any():
                background, sky = background + sky.radiance[0, 0], None
        panorama = None if sky is None else sky._panorama(self.dtype)
        return light._table("lights", lights), tuple(float(c) for c in background), panorama

    def given(self, moment: Moment) -> tuple[Any, ...]:
        """The scene at a moment, as kernels take it."""
        a, copies = (moment.arrays, None) if self.copies is None else self.copies.join(moment.arrays)
        offset = surface_offset(self._with_copies(moment.arrays.positions))
        tables = (a.positions, a.faces, a.normals, a.material_ids, a.kinds, a.rows, a.emission)
        flat = [np.require(x, requirements=["C", "A"]) for x in tables]
        lights, background, sky = self._sources
        return moment.bvh._tree, flat[:4], a.colors, flat[4:], lights, (background, offset, sky), copies

    def at(self, time: float) -> tuple[SceneArrays, BVH]:
        """The scene at a time in [0, 1]."""
        if time == 0 or not self.scene.moves:
            return self.arrays, self.bvh
        arrays = self._rest.flatten(self.dtype, time)
        return arrays, self.bvh.refit(arrays.positions)

    def moments(self, start: int, samples: int, seed: int) -> Iterator[Moment]:
        """Samples `start` … `start + samples` by the moments at which they see the scene.

        A still scene has one, and each ray has a time of its own. Where things move, moments are a van der Corput
        sequence over the time that the shutter is open, shifted by chance (anew where more samples share a moment):
        any run of them is spread evenly, and each by itself is even over the time, so that means are unbiased.
        """
        opened, closed = self.scene.camera.shutter
        if samples == 0 or not self.scene.moves:
            yield Moment(start, samples, self.arrays, self.bvh, None)
            return
        if opened == closed:
            arrays, bvh = self.at(opened)
            yield Moment(start, samples, arrays, bvh, None)
            return
        each = -(-samples // _MOMENTS)
        shift = float(np.random.Generator(np.random.Philox(key=[seed, each])).random())
        for first in range(start, start + samples, each):
            time = opened + (closed - opened) * ((_reversed_digits(first // each) + shift) % 1.0)
            arrays, bvh = self.at(time)
            yield Moment(first, min(each, start + samples - first), arrays, bvh, (time, time))


def _reversed_digits(i: int) -> float:
    """The binary digits of `i` after the point, the lowest first."""
    return int(f"{i:032b}"[::-1], 2) / 2**32
