"""Panoramas: their convention, densities that integrate to one, draws that follow them, and validation."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats
from shadelab.environment import Environment

FLOATS = [np.float32, np.float64]


def picture(height=8, width=16, seed=1, dtype=np.float64):
    rng = np.random.default_rng(seed)
    return (rng.gamma(0.3, 1.0, (height, width, 3)) * 4).astype(dtype)


def grid(height, width):
    """Directions at even steps of both angles, with the solid angles of the patches about them."""
    polar = np.pi * (np.arange(height) + 0.5)[:, None] / height
    azimuth = 2 * np.pi * (np.arange(width) + 0.5) / width
    r, y = np.sin(polar), np.broadcast_to(np.cos(polar), (height, width))
    weight = r * 2 * np.sin(np.pi / height / 2) * 2 * np.pi / width
    return np.stack([r * np.cos(azimuth), y, r * np.sin(azimuth)], -1), weight


@pytest.mark.parametrize("dtype", FLOATS)
def test_the_convention(dtype):
    sky = np.zeros((4, 8, 3), dtype)
    sky[:, 3:5, 0] = 1  # the centre: −z
    sky[:, 5:7, 1] = 1  # to the right of it: +x
    sky[0, :, 2] = 1  # the top: +y
    e = Environment(sky)
    got = e.eval(np.array([[0, 0, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype))
    assert got.dtype == dtype
    assert got[0, 0] == pytest.approx(1, abs=1e-5) and got[1, 1] == pytest.approx(1, abs=1e-5)
    assert got[2, 2] == 1 and got[3, :2].max() < 1e-5


@pytest.mark.parametrize("dtype", FLOATS)
@pytest.mark.parametrize("rotation", [0.0, 0.7, -9.0])
def test_pixels_are_themselves_at_their_centres(dtype, rotation):
    e = Environment(picture(dtype=dtype), rotation=rotation)
    # A direction is off by some units of rounding, a pixel's neighbour by up to 40.
    assert np.allclose(e.eval(e.directions()), e.radiance, atol=2000 * np.finfo(dtype).eps)


def test_a_turn_is_counter_clockwise_from_above():
    plain, turned = Environment(picture()), Environment(picture(), rotation=0.4)
    d = np.random.default_rng(2).normal(size=(100, 3))
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    back = sl.transform.rotate_axis([0, 1, 0], -0.4)[:3, :3]
    assert np.allclose(turned.eval(d), plain.eval(d @ back.T), atol=1e-11)


@pytest.mark.parametrize("size", [(1, 1), (2, 1), (1, 3), (8, 16), (33, 65)])
def test_densities_integrate_to_one(size):
    e = Environment(picture(*size), rotation=0.3)
    directions, weight = grid(1000, 1000)
    # A million points over kinks at the pixels' centres, and a density that grows as 1 / sin θ at the poles.
    assert float((e.pdf(directions) * weight).sum()) == pytest.approx(1, abs=2e-3)


@pytest.mark.parametrize("dtype", FLOATS)
def test_draws_say_what_the_panorama_says(dtype):
    e = Environment(picture(dtype=dtype), rotation=1.0)
    wi, radiance, pdf = e.sample(sl.sampling.sobol(4096, 2, dtype=dtype))
    assert wi.dtype == radiance.dtype == pdf.dtype == dtype
    eps = np.finfo(dtype).eps
    assert np.allclose(np.linalg.norm(wi, axis=-1), 1, atol=4 * eps)
    scale = radiance.max()
    # The azimuth of a direction is off by its rounding over the sine, and pixels are 0.4 wide.
    sine = np.sqrt(1 - np.minimum(wi[:, 1] ** 2, 1))
    fine = sine > 0.01
    assert np.abs(e.eval(wi) - radiance)[fine].max() < 2000 * eps * scale
    assert np.abs(e.pdf(wi) / pdf - 1)[fine & (pdf > 1e-3)].max() < 1e5 * eps


def test_draws_follow_the_density():
    e = Environment(picture(6, 12, 5))
    n = 1 << 16
    wi, radiance, pdf = e.sample(np.random.default_rng(3).random((n, 2)))
    # Boxes of even angles; the expected count by a fine grid within each.
    fine, weight = grid(600, 1200)
    expected = (e.pdf(fine) * weight).reshape(12, 50, 24, 50).sum((1, 3)) * n
    azimuth = np.arctan2(wi[:, 2], wi[:, 0]) % (2 * np.pi)
    row = np.minimum((np.arccos(wi[:, 1]) / np.pi * 12).astype(int), 11)
    column = np.minimum((azimuth / (2 * np.pi) * 24).astype(int), 23)
    found = np.bincount(row * 24 + column, minlength=288).reshape(12, 24)
    many = expected > 5
    pooled = np.append(found[many], found[~many].sum()), np.append(expected[many], expected[~many].sum())
    keep = pooled[1] > 0
    pooled = pooled[0][keep], pooled[1][keep]
    assert expected.sum() == pytest.approx(n, rel=1e-3)
    # One test at the level of 0.1 %, with its seed fixed.
    assert stats.chisquare(pooled[0], pooled[1] * n / pooled[1].sum()).pvalue > 1e-3
    # So means of draws are integrals.
    share = sl.color.luminance(radiance) / pdf
    reference = (sl.color.luminance(e.eval(fine)) * weight).sum()
    assert share.mean() == pytest.approx(reference, rel=3e-3)
    assert e.power == pytest.approx(reference, rel=2e-2)  # for it, sines are those of the pixels' centres


def test_weights_hardly_vary():
    # All but the sine between the centres of two rows is in the density: 21 % between 30 and 37.5 degrees.
    e = Environment(picture(24, 48, 5))
    wi, radiance, pdf = e.sample(np.random.default_rng(3).random((1 << 14, 2)))
    share = sl.color.luminance(radiance) / pdf
    inner = np.abs(wi[:, 1]) < np.cos(np.pi / 6)
    assert share[inner].max() / share[inner].min() < 1.5


def test_one_bright_pixel_takes_the_draws():
    sky = np.full((64, 128, 3), 1.0)
    sky[20, 30] = 1e6
    e = Environment(sky)
    wi, radiance, pdf = e.sample(np.random.default_rng(1).random((4096, 2)))
    near = wi @ e.directions()[20, 30] > np.cos(2 * np.pi / 64 * 1.5)
    rest = 4 * np.pi / (e.power)
    assert 1 - near.mean() == pytest.approx(rest, abs=3 * np.sqrt(rest / 4096))
    assert (sl.color.luminance(radiance) / pdf).std() / e.power < 0.05


def test_black_is_drawn_from_evenly():
    e = Environment(np.zeros((16, 32, 3)))
    wi, radiance, pdf = e.sample(sl.sampling.sobol(1 << 12, 2))
    assert radiance.max() == 0 and np.isfinite(pdf).all() and (pdf > 0).all()
    assert np.abs(wi.mean(0)).max() < 0.01


@pytest.mark.parametrize("dtype", FLOATS)
def test_ends_of_the_square_and_poles_are_finite(dtype):
    e = Environment(picture(dtype=dtype))
    ends = np.array([0, 0.5, 1 - np.finfo(dtype).eps / 2], dtype)
    wi, radiance, pdf = e.sample(np.stack(np.meshgrid(ends, ends), -1))
    assert np.isfinite(wi).all() and np.isfinite(radiance).all() and np.isfinite(pdf).all()
    poles = np.array([[0, 1, 0], [0, -1, 0], [-0.0, 1, -0.0]], dtype)
    assert np.isfinite(e.pdf(poles)).all() and np.isfinite(e.eval(poles)).all()


def test_nan_stays_at_its_element():
    e = Environment(picture())
    got = e.eval([[np.nan, 0, 1], [0, 0, 1.0]])
    assert np.isnan(got[0]).all() and np.isfinite(got[1]).all()
    wi, _, pdf = e.sample([[0.5, np.nan], [0.5, 1.5], [0.5, 0.5]])
    assert np.isnan(wi[:2]).all() and np.isnan(pdf[:2]).all() and np.isfinite(pdf[2])


def test_files_and_bad_pictures(tmp_path):
    from shadelab import scene

    scene.save_image(tmp_path / "sky.exr", picture(dtype=np.float32))
    e = Environment.load(tmp_path / "sky.exr", scale=2.0)
    assert np.array_equal(e.radiance, 2 * picture(dtype=np.float32))
    with pytest.raises(ValueError, match=r"radiance: expected finite values from zero on, got .* at \(1, 2\)"):
        bad = picture()
        bad[1, 2, 0] = -1
        Environment(bad)
    with pytest.raises(ValueError, match="radiance: expected shape"):
        Environment(np.ones((4, 8, 2)))
    with pytest.raises(TypeError, match="radiance: expected linear"):
        Environment(np.ones((4, 8, 3), np.uint8))
    with pytest.raises(ValueError, match="background: expected none beside an environment"):
        scene.Scene(sl.mesh.box(), background=(1, 1, 1), environment=e)
