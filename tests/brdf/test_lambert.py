"""The diffuser: Mitsuba's, and its albedo is what it gives back."""

import numpy as np
import pytest
import shadelab as sl


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_gives_back_its_albedo(dtype):
    u = sl.sampling.sobol(1 << 12, 2, dtype=dtype)
    wi = sl.sampling.square_to_cosine_hemisphere(u)
    albedo = np.array([0.2, 0.5, 1.0], dtype)
    f = sl.brdf.lambert(wi, np.array([0.6, 0, 0.8], dtype), albedo)
    assert f.dtype == dtype
    weight = f * (wi[:, 2] / sl.sampling.square_to_cosine_hemisphere_pdf(wi))[:, None]
    # Each sample alone gives the albedo: a few roundings.
    assert np.allclose(weight, albedo, rtol=4 * np.finfo(dtype).eps)


def test_agrees_with_mitsuba():
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    bsdf = mi.load_dict({"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.2, 0.5, 0.9]}})
    si = mi.SurfaceInteraction3f()
    si.wi = [0.6, 0.0, 0.8]
    wi = [0.0, 0.8, 0.6]
    got = sl.brdf.lambert(wi, [0.6, 0.0, 0.8], [0.2, 0.5, 0.9]) * 0.6
    # Mitsuba computes in single precision.
    assert np.allclose(got, bsdf.eval(mi.BSDFContext(), si, wi), rtol=1e-6)


def test_nothing_passes_the_horizon_and_bad_albedos_give_nan():
    up, down = [0.0, 0.0, 1.0], [0.0, 0.6, -0.8]
    got = sl.brdf.lambert([up, down, up, up], [up, up, down, up], [[0.5] * 3, [0.5] * 3, [0.5] * 3, [0.5, 1.5, 0.5]])
    assert np.array_equal(got[1:3], np.zeros((2, 3)))
    assert np.isnan(got[3, 1]) and got[3, 0] == got[0, 0] > 0
