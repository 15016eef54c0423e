"""A scene as kernels take it: at one time, or at the times at which samples see it while the shutter is open.

What is made of a scene (arrays in the world, hierarchies) is kept until another scene is traced, or that one is gone,
or anything of it has changed: small pictures would take longer to prepare than to trace.
"""

from __future__ import annotations

import weakref
from collections.abc import Hashable, Iterator
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, cast, get_args

import numpy as np
from numpy.typing import NDArray

from .. import _arrays, light
from .._arrays import Floats
from ..accel import BVH
from ._common import check_bvh, surface_offset
from ._copies import Copies, Sharing, shareable

if TYPE_CHECKING:
    from ..scene import Scene, SceneArrays

_SHARING = get_args(Sharing)
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


class _Made:
    """A scene at time 0: copies, what is flattened (all but these), and what is known of that."""

    def __init__(self, scene: Scene, shared: list[int], dtype: np.dtype[Any]) -> None:
        # No reference to the scene itself, which may go.
        self.copies = Copies(scene, shared, dtype) if shared else None
        self.arrays = (self.copies.rest if self.copies else scene).flatten(dtype)

    @cached_property
    def bvh(self) -> BVH:
        return BVH(self.arrays.positions, self.arrays.faces)

    @cached_property
    def tables(self) -> Tables:
        return _tables(self.copies, self.arrays)

    @cached_property
    def coarse(self) -> bool:
        """Whether the precision loses shapes, for which each picture warns."""
        positions = _with_copies(self.copies, self.arrays.positions)
        return _arrays.coarse_step(positions, self.arrays.positions.dtype) > 0


class Tables(NamedTuple):
    """Arrays as kernels take them."""

    first: list[NDArray[Any]]
    """Positions, faces, normals, numbers of materials."""
    colors: Floats | None
    last: list[NDArray[Any]]
    """Kinds, parameters and emission of materials."""
    copies: Any
    offset: float
    """How far above a surface rays start."""


def _with_copies(copies: Copies | None, positions: Any) -> Any:
    """Positions of the rest, and the corners of the boxes of copies."""
    return positions if copies is None else np.concatenate([positions, copies.corners])


def _tables(copies: Copies | None, arrays: SceneArrays) -> Tables:
    a, given = (arrays, None) if copies is None else copies.join(arrays)
    tables = (a.positions, a.faces, a.normals, a.material_ids, a.kinds, a.rows, a.emission)
    flat = [np.require(x, requirements=["C", "A"]) for x in tables]
    return Tables(flat[:4], a.colors, flat[4:], given, surface_offset(_with_copies(copies, arrays.positions)))


def _contents(scene: Scene, shared: list[int], dtype: np.dtype[Any]) -> Hashable:
    """All that a flattened scene depends on: arrays may have been written to since."""
    # Without a call for each array: small pictures wait for this.
    found: list[Any] = [dtype, tuple(shared)]
    numbers: dict[int, int] = {}
    for instance in scene.instances:
        mesh = instance.mesh
        if id(mesh) not in numbers:
            numbers[id(mesh)] = len(numbers)
            for a in (mesh.positions, mesh.faces, mesh.normals, mesh.colors, mesh.uvs, mesh.material_ids):
                found.append(None if a is None else (a.shape, a.dtype, hash(a.tobytes())))
        found += (numbers[id(mesh)], instance.transform.tobytes(), instance.materials)
    return tuple(found)


_kept: tuple[weakref.ref[Any], Hashable, _Made] | None = None


def _forget(gone: weakref.ref[Any]) -> None:
    global _kept
    if _kept is not None and _kept[0] is gone:
        _kept = None


def _made(scene: Scene, shared: list[int], dtype: np.dtype[Any]) -> _Made:
    """The scene flattened, as it was kept if nothing has changed."""
    global _kept
    from ..scene import Scene

    if type(scene) is not Scene:
        return _Made(scene, shared, dtype)
    contents, kept = _contents(scene, shared, dtype), _kept
    if kept is not None and kept[0]() is scene and kept[1] == contents:
        return kept[2]
    # Before the next is made, that both are not in memory.
    _kept = kept = None
    made = _Made(scene, shared, dtype)
    _kept = weakref.ref(scene, _forget), contents, made
    return made


class World:
    """The scene and its hierarchy at time 0, refitted at others."""

    def __init__(
        self,
        scene: Scene,
        bvh: BVH | None,
        dtype: np.dtype[Any],
        instances: Sharing,
        rays: int,
        all_directions: bool = False,
    ) -> None:
        """With `all_directions`, light that comes evenly from everywhere is background, not a source to be asked.

        `rays` are those from the camera in all the pictures, by which "auto" chooses what is traced as copies.
        """
        if not callable(getattr(scene, "flatten", None)) or isinstance(scene, np.ndarray):
            raise TypeError(f"scene: expected a Scene, got {type(scene).__name__}")
        self.scene, self.dtype = scene, dtype
        sharing = cast("Sharing", _arrays.choice("instances", instances, _SHARING))
        self.shared = shareable(scene, sharing, rays) if bvh is None else []
        self._made = made = _made(scene, self.shared, dtype)
        self.copies, self.arrays = made.copies, made.arrays
        self._rest = self.copies.rest if self.copies else scene
        if bvh is None:
            bvh = made.bvh
        else:
            check_bvh(bvh)
            own, mine = (bvh._positions, bvh._faces), (self.arrays.positions, self.arrays.faces)
            if own[0].dtype != dtype or not all(np.array_equal(a, b) for a, b in zip(own, mine, strict=True)):
                raise ValueError(f"bvh: expected one of the flattened scene in {dtype}")
        self.bvh = bvh
        self._all_directions = all_directions
        if made.coarse:
            _arrays.warn_if_coarse(_with_copies(self.copies, self.arrays.positions), dtype, 5)

    @cached_property
    def _sources(self) -> tuple[Any, tuple[float, ...], Any]:
        """The lights; the background; the panorama."""
        scene = self.scene
        lights, background, sky = scene.lights, list(scene.background), scene.environment
        if self._all_directions:
            ambient = [lamp.radiance for lamp in lights if isinstance(lamp, light.AmbientLight)]
            if ambient:
                lights = [lamp for lamp in lights if not isinstance(lamp, light.AmbientLight)]
            if sky is not None and all((row == sky.radiance[0, 0]).all() for row in sky.radiance):
                ambient, sky = [*ambient, sky.radiance[0, 0].tolist()], None
            background = [sum(channel) for channel in zip(background, *ambient, strict=True)]
        panorama = None if sky is None else sky._panorama(self.dtype)
        return light._table("lights", lights), tuple(map(float, background)), panorama

    def all_arrays(self, arrays: SceneArrays) -> SceneArrays:
        """What is flattened, and the meshes of copies behind it in their own space."""
        return arrays if self.copies is None else self.copies.join(arrays)[0]

    def numbers(self) -> Numbers:
        """What faces, instances and materials are called."""
        return Numbers(self)

    def given(self, moment: Moment) -> tuple[Any, ...]:
        """The scene at a moment, as kernels take it."""
        kept = moment.arrays is self.arrays
        tables = self._made.tables if kept else _tables(self.copies, moment.arrays)
        lights, background, sky = self._sources
        first, colors, last, copies, offset = tables
        return moment.bvh._tree, first, colors, last, lights, (background, offset, sky), copies

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


class Numbers:
    """What faces, instances and materials of a world are called in the flattened scene."""

    def __init__(self, world: World) -> None:
        copies, ids = world.copies, world.arrays.instance_ids
        self.instances = [ids, np.empty(0, np.int32)]
        self._tables: tuple[Any, Any] | None = None
        if copies is None:
            return
        whole = world.scene.instances
        others = np.setdiff1d(np.arange(len(whole), dtype=np.int32), copies.numbers)
        self.instances = [others[ids], copies.numbers]
        # Where the faces of each instance begin, here less there.
        counts = np.array([len(i.mesh.faces) for i in whole])
        begin = np.zeros(len(whole), np.int64)
        begin[others] = np.cumsum(counts[others]) - counts[others]
        joined, (_, (first_face, *_)) = copies.join(world.arrays)
        begin[copies.numbers] = first_face
        rows: dict[Any, int] = {}
        for instance in whole:
            for material in instance.materials:
                rows.setdefault(material, len(rows))
        self._tables = (
            begin - (np.cumsum(counts) - counts),
            np.array([rows.get(m, -1) for m in joined.materials], np.int32),
        )

    def flattened(self, face: NDArray[np.int32], instance: NDArray[np.int32], material: NDArray[np.int32]) -> None:
        """Renames in place what is not −1."""
        if self._tables is not None:
            shift, rows = self._tables
            hit = instance >= 0
            face[hit] -= shift[instance[hit]].astype(np.int32)
            material[hit] = rows[material[hit]]


def _reversed_digits(i: int) -> float:
    """The binary digits of `i` after the point, the lowest first."""
    return int(f"{i:032b}"[::-1], 2) / 2**32
