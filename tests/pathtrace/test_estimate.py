"""Pictures round by round: frames, adaptive stops and clamping with their biases, outliers, lenses, time."""

import numpy as np
import pytest
import shadelab as sl
from shadelab import mesh, scene
from shadelab.light import RectLight
from shadelab.pathtrace import PixelFilter, path_trace, progressive

from .recursion_scenes import cards, glowing, mitsuba_picture
from .scenes import lambert, thing

SIZE = (48, 32)


def rare():
    """A floor lit by a small bright panel that emits, found by the material's directions alone: one in hundreds."""
    things = [
        thing(mesh.plane((6, 6)), lambert(0.6, 0.6, 0.6), (0, -0.5, 0)),
        thing(mesh.plane((0.3, 0.3)), glowing((60, 60, 60)), (0, 1.0, 0)),
    ]
    return scene.Scene(things, (), scene.Camera((0, 1.2, 3), (0, 0, 0), fov_y=0.6), background=(0.05, 0.05, 0.05))


def lit():
    lamp = RectLight((0, 2, 0), (1, 0, 0), (0, 0, 1), (4, 4, 5))
    things = [
        thing(mesh.plane((6, 6)), lambert(0.5, 0.4, 0.3), (0, -0.5, 0)),
        thing(mesh.box((0.6, 1.0, 0.6)), lambert(0.2, 0.4, 0.7), (-0.5, 0, 0), 0.5),
    ]
    return scene.Scene(things, lamp, scene.Camera((0, 1.2, 3.2), (0, 0, 0), fov_y=0.7), background=(0.2, 0.2, 0.3))


def test_frames_refine_to_the_whole_picture():
    frames = list(progressive(lit(), SIZE, 20, 3, seed=4, first=2))
    assert [int(f.samples.min()) for f in frames] == [2, 4, 8, 16, 20]
    assert all((f.samples == f.samples[0, 0]).all() for f in frames)
    errors = [f.error for f in frames]
    assert errors[-1] < errors[1] < errors[0]
    whole = path_trace(lit(), SIZE, 20, 3, seed=4)
    assert np.allclose(frames[-1].radiance, whole.radiance, rtol=1e-5, atol=1e-6)
    assert np.allclose(frames[-1].variance, whole.variance, rtol=1e-3, atol=1e-8)
    # Frames do not change once they are given.
    first = frames[0].radiance.copy()
    assert np.array_equal(first, next(iter(progressive(lit(), SIZE, 20, 3, seed=4, first=2))).radiance)


def test_progress_is_told_and_arguments_are_checked_at_once():
    told = []
    list(progressive(lit(), (24, 16), 4, 2, progress=lambda done, total: told.append((done, total))))
    assert told and all(0 <= done <= total for done, total in told)
    with pytest.raises(ValueError, match="first: expected an integer"):
        progressive(lit(), SIZE, first=0)
    with pytest.raises(ValueError, match="filter: expected one of"):
        progressive(lit(), SIZE, filter="mitchell")


def test_merging_counts_pixel_by_pixel():
    adaptive = path_trace(lit(), SIZE, 1024, 2, seed=1, target_error=0.03)
    assert adaptive.samples.min() == 32 < adaptive.samples.max()
    other = path_trace(lit(), SIZE, 64, 2, seed=2)
    merged = adaptive.merge(other)
    assert np.array_equal(merged.samples, adaptive.samples + 64)
    n, m = adaptive.samples[..., None].astype(float), 64.0
    wanted = (n * adaptive.radiance + m * other.radiance) / (n + m)
    assert np.allclose(merged.radiance, wanted, rtol=1e-5)
    with pytest.raises(ValueError, match="other: expected both pictures clamped or none"):
        other.merge(path_trace(lit(), SIZE, 8, 2, clamp=1.0))


def test_each_tile_reaches_its_target():
    target = 0.04
    got = path_trace(lit(), SIZE, 1 << 14, 2, target_error=target)

    def tiles(x):
        return x.astype(float).reshape(4, 8, 6, 8, -1).mean((1, 3, 4))

    mean = tiles(got.radiance)
    assert (np.sqrt(tiles(got.variance)) <= target * np.maximum(mean, 0.05 * mean.mean()) * (1 + 1e-5)).all()
    # Samples go where noise is: even sky needs none but the first.
    assert got.samples.min() == 32 and got.samples.max() >= 128
    # As tiles have one number of samples each.
    assert (np.ptp(got.samples.reshape(4, 8, 6, 8), axis=(1, 3)) == 0).all()


def test_adaptive_stopping_is_biased_by_less_than_its_target():
    """Twelve pictures of light that is hard to find, against a long run: the bias is there, and below the target."""
    options = {"strategy": "bsdf", "sampler": "independent"}
    reference = path_trace(rare(), (24, 16), 1 << 14, 1, seed=99, **options)
    runs = [path_trace(rare(), (24, 16), 2048, 1, seed=s, target_error=0.2, **options) for s in range(12)]
    means = np.array([r.radiance.mean(dtype=float) for r in runs])
    truth = reference.radiance.mean(dtype=float)
    assert min(r.samples.min() for r in runs) < 2048
    bias = means.mean() / truth - 1
    error = means.std(ddof=1) / np.sqrt(len(means)) / truth
    assert abs(bias) < 0.2 and bias < 4 * error


def test_clamping_says_what_it_took():
    options = {"strategy": "bsdf", "sampler": "independent", "seed": 7}
    free, clamped = (path_trace(rare(), SIZE, 256, 1, clamp=c, **options) for c in (None, 2.0))
    assert free.removed is None and clamped.removed is not None
    assert (clamped.radiance <= 2.0).all() and clamped.radiance.mean() < 0.9 * free.radiance.mean()
    # The same samples: what was taken and what is left are the whole, to single precision.
    assert np.allclose(clamped.radiance + clamped.removed, free.radiance, rtol=1e-5, atol=1e-6)
    assert clamped.variance.mean() < free.variance.mean()
    # Outliers are told of either; beside clamped means the same samples weigh more.
    assert free.outliers.sum() > 0 and (clamped.outliers >= free.outliers).all()
    loose = path_trace(rare(), SIZE, 16, 1, clamp=1e6, **options)
    assert not loose.removed.any()
    with pytest.raises(ValueError, match="clamp: expected a number"):
        path_trace(rare(), SIZE, 1, clamp=0)


def test_outliers_are_rare_where_light_is_plain():
    got = path_trace(lit(), SIZE, 256, 2)
    assert got.outliers.shape == SIZE[::-1] and got.outliers.mean() < 0.01


@pytest.mark.parametrize("name", ["box", "tent", "gaussian", "blackman_harris"])
def test_filters_move_light_but_make_none(name):
    """A picture that is dark at its border keeps its sum under every filter."""
    upright = sl.transform.rotate_axis((1, 0, 0), np.pi / 2)
    card = scene.Instance(mesh.plane((0.5, 0.4)), upright, glowing((1, 1, 1)))
    world = scene.Scene(card, (), scene.Camera((0, 0, 4), (0, 0, 0), fov_y=0.3))
    sharp = path_trace(world, SIZE, 1, 0, filter=PixelFilter("box", 0.5), dtype=np.float64)
    got = path_trace(world, SIZE, 256, 0, filter=name)
    area = 0.2 / (4 * 2 * np.tan(0.15) / 32) ** 2
    assert got.radiance[..., 0].sum() == pytest.approx(area, rel=5e-3)
    assert sharp.radiance[..., 0].sum() == pytest.approx(area, rel=0.1)


def test_lens_agrees_with_mitsuba(tmp_path):
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    world = cards(aperture=0.4, focus_distance=3.0)
    runs = np.stack([mitsuba_picture(mi, world, tmp_path, SIZE, 64, s) for s in range(8)])
    ours = np.stack([path_trace(world, SIZE, 64, 2, seed=s).radiance for s in range(8)])
    sigma = np.sqrt(runs.var(0, ddof=1) / 8 + ours.var(0, ddof=1) / 8 + 1e-7)
    z = (ours.mean(0) - runs.mean(0)) / sigma
    # Pixel by pixel, 14 degrees of freedom and fewer: the seeds are fixed.
    assert np.sqrt((z**2).mean()) < 1.4 and np.abs(z).max() < 9


def test_a_moving_thing_leaves_its_light_along_its_way():
    upright = sl.transform.rotate_axis((1, 0, 0), np.pi / 2)
    card = mesh.plane((1, 1)).transformed(upright)
    moving = scene.Instance(card, None, glowing((1, 1, 1)), sl.transform.translate((0.5, 0, 0)))
    world = scene.Scene(moving, (), scene.Camera((0, 0, 4), (0, 0, 0), fov_y=0.4))
    assert world.moves
    row = path_trace(world, SIZE, 256, 0).radiance[16, :, 0]
    x = (np.arange(48) + 0.5 - 24) * 8 * np.tan(0.2) / 32
    assert np.abs(row - np.clip((x + 0.5) / 0.5, 0, 1) * np.clip((1 - x) / 0.5, 0, 1)).max() < 0.04
    # Half the shutter, half the way.
    half = scene.Scene(moving, (), scene.Camera((0, 0, 4), (0, 0, 0), fov_y=0.4, shutter=(0, 0.5)))
    row = path_trace(half, SIZE, 256, 0).radiance[16, :, 0]
    assert np.abs(row - np.clip((x + 0.5) / 0.25, 0, 1) * np.clip((0.75 - x) / 0.25, 0, 1)).max() < 0.06
    # A shadow moves with what casts it, and further samples see further moments.
    parts = [path_trace(world, SIZE, 16, 0, start=s).radiance for s in (0, 16)]
    assert not np.array_equal(parts[0], parts[1])


@pytest.mark.parametrize("sampler", ["stratified", "latin_hypercube", "multi_jittered"])
def test_each_round_is_a_set_of_its_own(sampler):
    """Rounds are what runs of that size from there are, and so is a run that goes on where another ended."""
    options = {"max_depth": 3, "seed": 4, "sampler": sampler}
    *_, last = progressive(lit(), SIZE, 64, first=32, **options)
    again = path_trace(lit(), SIZE, 32, **options).merge(path_trace(lit(), SIZE, 32, start=32, **options))
    assert np.allclose(last.radiance, again.radiance, rtol=1e-5, atol=1e-7)
    adaptive = path_trace(lit(), SIZE, 64, target_error=1e-9, **options)
    assert np.allclose(adaptive.radiance, last.radiance, rtol=1e-5, atol=1e-7)


def edge_error(sampler, seeds=24):
    """Of the pixels along the border of a slanted black card, in frames of 32, 64 and 128 samples, by rounds."""
    slanted = sl.transform.rotate_axis((0, 0, 1), 0.3) @ sl.transform.rotate_axis((1, 0, 0), np.pi / 2)
    card = scene.Instance(mesh.plane((4, 4)), slanted @ sl.transform.translate((2, 0, 0)), (scene.Material((0, 0, 0)),))
    world = scene.Scene([card], (), scene.Camera((0, 0, 3), (0, 0, 0)), background=(1, 1, 1))
    truth = path_trace(world, (16, 16), 8192, 0, seed=99, sampler="sobol").radiance[..., 0]
    edge = (truth > 0.1) & (truth < 0.9)
    runs = [list(progressive(world, (16, 16), 128, 0, s, first=32, sampler=sampler)) for s in range(seeds)]
    return np.array([[np.mean((f.radiance[..., 0] - truth)[edge] ** 2) for f in run] for run in runs]).mean(0)


def test_rounds_keep_their_strata():
    plain, strata, grid = (edge_error(s) for s in ("independent", "stratified", "multi_jittered"))
    # Cells that an edge does not cross are known for certain: of 32, 32 + 32 and 32 + 32 + 64 samples a
    # quarter to a sixth of the squared error is left; rounds cut out of larger sets left 0.25, 0.35 and 0.41.
    for ratio in (strata / plain, grid / plain):
        assert (ratio < [0.4, 0.3, 0.25]).all()
