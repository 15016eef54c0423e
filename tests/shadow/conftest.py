"""Scenes whose shadows are known in closed form."""

from types import SimpleNamespace

import numpy as np
import pytest
from shadelab.light import DirectionalLight, PointLight, RectLight

DOWN = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]


def quad(height, x, z, dtype=np.float32):
    """A horizontal rectangle, facing up."""
    (x0, x1), (z0, z1) = x, z
    positions = np.array([[x0, height, z0], [x1, height, z0], [x1, height, z1], [x0, height, z1]], dtype)
    return positions, np.array([[0, 2, 1], [0, 3, 2]], np.int32)


def join(*meshes):
    positions = np.concatenate([p for p, _ in meshes])
    offsets = np.cumsum([0] + [len(p) for p, _ in meshes[:-1]])
    return positions, np.concatenate([f + o for (_, f), o in zip(meshes, offsets, strict=True)]).astype(np.int32)


def rect_light(height=4.0, side=1.0, center=(0.0, 0.0)):
    """A square light that shines down."""
    return RectLight(center=(center[0], height, center[1]), edge_u=(side, 0, 0), edge_v=(0, 0, side))


def lights():
    """One of each kind, above and about the origin."""
    return {
        "rect": rect_light(),
        "point": PointLight((0.2, 4.0, 0.1)),
        "sun": DirectionalLight((0.3, -1.0, 0.2)),
    }


def towards_light(light, points):
    """Unit vectors from points to a light's centre."""
    if isinstance(light, DirectionalLight):
        away = np.broadcast_to(-np.array(light.direction), points.shape)
    else:
        away = getattr(light, "center", getattr(light, "position", None)) - points
    return away / np.linalg.norm(away, axis=-1, keepdims=True)


def analytic_map(sl, dtype=np.float32, n=256, blocker=2.0, ground=4.0):
    """A light 4 above the ground; a half-plane x < 0 at depth `blocker`, drawn without the rasteriser."""
    x = np.arange(n) + 0.5 - n / 2
    depth = np.where(x < 0, blocker, ground).astype(dtype)[None].repeat(n, 0)
    return sl.shadow.ShadowMap(depth, "perspective", [0, 4, 0], DOWN, [-1, 1, -1, 1], blocker, ground)


def plane_receivers(n=256, dtype=np.float64, half=4.0):
    """The ground points under the texel centres of `analytic_map`, and the mean of what lies about each."""
    at = (np.arange(n) + 0.5) / n * 2 - 1
    x, z = np.meshgrid(at * half, at * half)
    return np.stack([x, 0 * x, z], -1).astype(dtype)


@pytest.fixture(scope="session")
def scenes():
    return SimpleNamespace(
        quad=quad,
        join=join,
        rect_light=rect_light,
        analytic_map=analytic_map,
        lights=lights,
        towards_light=towards_light,
        plane_receivers=plane_receivers,
    )
