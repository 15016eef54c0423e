"""Distributed ray tracing: gloss, penumbrae, lens, filters and time against path tracing, Mitsuba and closed forms."""

import numpy as np
import pytest
import shadelab as sl
from shadelab import mesh, scene
from shadelab.light import RectLight
from shadelab.pathtrace import PixelFilter, distribution, path_trace

from .recursion_scenes import GLOW, cards, glowing, mitsuba_picture, tiles
from .scenes import lambert, thing

SIZE = (48, 32)


def scores(ours, theirs, variance):
    z = (tiles(ours) - tiles(theirs)) * 8 / np.sqrt(tiles(variance) + 1e-10)
    return np.abs(z).max(), np.sqrt((z**2).mean())


def test_penumbrae_are_direct_light():
    lamp = RectLight((0, 2, 0), (1, 0, 0), (0, 0, 1), (4, 4, 5))
    things = [
        thing(mesh.plane((6, 6)), lambert(0.5, 0.4, 0.3), (0, -0.5, 0)),
        thing(mesh.icosphere(3, 0.5), scene.Material((0.9, 0.6, 0.3), 0.0, 0.4), (0, 0, 0)),
    ]
    world = scene.Scene(things, lamp, scene.Camera((0, 1.2, 3.2), (0, 0, 0), fov_y=0.7))
    ours, theirs = distribution(world, SIZE, 256, 0), path_trace(world, SIZE, 256, 1, seed=3)
    worst, typical = scores(ours.radiance, theirs.radiance, ours.variance + theirs.variance)
    assert worst < 4.5 and typical < 1.3


def test_gloss_is_path_tracings_where_nothing_is_matt():
    """Metal balls over glowing tiles in a sky: all light comes by mirrors, and each has a part of the lamp's."""
    tiles_ = [thing(mesh.plane((1.0, 3.0)), glowing(GLOW[i]), (i - 1.0, -0.5, 0)) for i in range(3)]
    ball = mesh.icosphere(3, 0.5)
    balls = [
        thing(ball, scene.Material((0.9, 0.7, 0.5), 1.0, 0.3), (-0.6, 0, 0)),
        thing(ball, scene.Material((0.9, 0.9, 0.9), 1.0, 0.6), (0.6, 0, 0.2)),
    ]
    lamp = RectLight((0, 2, 0), (1, 0, 0), (0, 0, 1), (3, 3, 3))
    world = scene.Scene(tiles_ + balls, lamp, scene.Camera((0, 1.2, 3.2), (0, 0, 0), fov_y=0.7), (0.3, 0.4, 0.5))
    ours, theirs = distribution(world, SIZE, 256, 5), path_trace(world, SIZE, 256, 6, seed=3)
    worst, typical = scores(ours.radiance, theirs.radiance, ours.variance + theirs.variance)
    assert worst < 4.5 and typical < 1.3


@pytest.mark.parametrize(
    ("name", "radius", "theirs"),
    [
        ("box", 0.5, "box"),
        ("tent", 1.0, {"type": "tent", "radius": 1.0}),
        ("gaussian", 2.0, {"type": "gaussian", "stddev": 0.5}),
    ],
)
def test_lens_and_filter_agree_with_mitsuba(name, radius, theirs, tmp_path):
    """Cards before, on and behind the plane of focus, pixel by pixel: both filters have the same mean."""
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    world = cards(aperture=0.3, focus_distance=4.0)
    runs = np.stack([mitsuba_picture(mi, world, tmp_path, SIZE, 64, s, rfilter=theirs) for s in range(8)])
    ours = np.stack(
        [distribution(world, SIZE, 64, seed=s, filter=PixelFilter(name, radius)).radiance for s in range(8)]
    )
    # Borders are left out: beyond them Mitsuba's film has no samples.
    inner = (slice(None), slice(4, -4), slice(4, -4))
    runs, ours = runs[inner], ours[inner]
    sigma = np.sqrt(runs.var(0, ddof=1) / 8 + ours.var(0, ddof=1) / 8 + 1e-7)
    z = (ours.mean(0) - runs.mean(0)) / sigma
    assert np.sqrt((z**2).mean()) < 1.3 and np.abs(z).max() < 8
    # Their means over the picture: splats of one sample are shared, so errors are taken from the runs.
    total = ours.mean((1, 2)) - 0
    error = np.sqrt(total.var(0, ddof=1) / 8 + runs.mean((1, 2)).var(0, ddof=1) / 8)
    assert (np.abs(total.mean(0) - runs.mean((0, 1, 2))) < 4.5 * error + 1e-4).all()


def test_a_point_is_blurred_to_its_circle_of_confusion():
    """A small card out of focus: the second moment of its image is that of a disk of the analytic radius."""
    upright = sl.transform.rotate_axis((1, 0, 0), np.pi / 2)
    dot = scene.Instance(mesh.plane((0.02, 0.02)), sl.transform.translate((0, 0, -2)) @ upright, glowing((1e3,) * 3))
    camera = scene.Camera((0, 0, 0), (0, 0, -1), fov_y=0.15, aperture=0.2, focus_distance=4.0)
    got = distribution(scene.Scene(dot, (), camera), (16, 16), 1 << 14).radiance[..., 0].astype(float)
    y, x = np.mgrid[:16, :16] + 0.5 - 8
    step = 2 * np.tan(0.075) / 16
    radius = 0.1 * abs(2 - 4) / (2 * 4) / step
    # A disk of radius r has ⟨x²⟩ = r²/4; the card and the pixel add a twelfth of their squared widths.
    # Some 18,000 samples meet the card: the moments are off by a hundredth.
    wanted = radius**2 / 4 + (0.01 / step) ** 2 / 12 + 1 / 12
    weight = got / got.sum()
    assert (weight * x**2).sum() == pytest.approx(wanted, rel=0.03)
    assert (weight * y**2).sum() == pytest.approx(wanted, rel=0.03)
    assert (got[np.hypot(x, y) > radius + 1.5] == 0).all()
    # No light is lost: as much as without a lens.
    sharp = distribution(scene.Scene(dot, (), scene.Camera((0, 0, 0), (0, 0, -1), fov_y=0.15)), (16, 16), 1 << 14)
    assert got.sum() == pytest.approx(float(sharp.radiance[..., 0].sum()), rel=0.03)


def test_a_moving_edge_is_a_ramp():
    upright = sl.transform.rotate_axis((1, 0, 0), np.pi / 2)
    card = mesh.plane((1, 1)).transformed(upright)
    moving = scene.Instance(card, None, glowing((1, 1, 1)), sl.transform.translate((0.5, 0, 0)))
    camera = scene.Camera((0, 0, 4), (0, 0, 0), fov_y=0.4)
    row = distribution(scene.Scene(moving, (), camera), SIZE, 256).radiance[16, :, 0]
    x = (np.arange(48) + 0.5 - 24) * 8 * np.tan(0.2) / 32
    wanted = np.clip((x + 0.5) / 0.5, 0, 1) * np.clip((1 - x) / 0.5, 0, 1)
    # 64 moments spread evenly: an edge is off by one of them, and noise by the pixel's own width.
    assert np.abs(row - wanted).max() < 0.04
    # A moving camera alone needs no moments: each ray has a time of its own.
    end = scene.Camera((-0.5, 0, 4), (-0.5, 0, 0), fov_y=0.4)
    eye = scene.Camera((0, 0, 4), (0, 0, 0), fov_y=0.4, end=end)
    still = scene.Scene(scene.Instance(card, None, glowing((1, 1, 1))), (), eye)
    row = distribution(still, SIZE, 1024).radiance[16, :, 0]
    assert np.abs(row - wanted).max() < 0.06


def test_variance_is_that_of_the_mean_and_runs_merge():
    world = cards(aperture=0.4, focus_distance=3.0)
    runs = [distribution(world, (24, 16), 16, seed=s) for s in range(40)]
    seen = np.stack([r.radiance for r in runs]).var(0, ddof=1).mean()
    stated = np.mean([r.variance.mean() for r in runs])
    assert stated == pytest.approx(seen, rel=0.1)
    merged = runs[0].merge(runs[1])
    assert (merged.samples == 32).all() and merged.error < runs[0].error
    with pytest.raises(ValueError, match="other: expected shape"):
        runs[0].merge(distribution(world, (8, 8), 2))


def test_extremes():
    sharp, pinhole = (distribution(cards(aperture=a), SIZE, 4).radiance for a in (0.0, 1e-12))
    assert np.abs(sharp - pinhole).mean() < 1e-3
    far = distribution(cards(aperture=0.1, focus_distance=np.inf), SIZE, 4).radiance
    assert np.isfinite(far).all() and far.any()
    point = distribution(cards(), SIZE, 2, filter=PixelFilter("gaussian", 1e-6))
    assert point.variance.max() < 1e-12
    dark = RectLight((0, 2, 0), (1e-15, 0, 0), (0, 0, 1e-15), (1, 1, 1))
    # As little as its area of 1e-30 sends.
    assert distribution(scene.Scene(mesh.box(), dark), (8, 8), 4).radiance.max() < 1e-29
    assert distribution(scene.Scene(mesh.box(), background=(1, 1, 1)), (8, 8), 4, 0).radiance[0, 0, 0] == 1
