"""The material: what it is made of, furnace, reciprocity, and a density that is the samples' own."""

import importlib.util
import itertools
from pathlib import Path

import numpy as np
import pytest
import shadelab as sl

spec = importlib.util.spec_from_file_location("brdf_common", Path(__file__).with_name("common.py"))
common = importlib.util.module_from_spec(spec)
spec.loader.exec_module(common)

WHITE = [1.0, 1.0, 1.0]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_ends_of_the_mix_are_ggx_and_lambert(dtype):
    wi, wo = common.directions(500, 1, dtype), common.directions(500, 2, dtype)
    color = np.array([0.9, 0.5, 0.1], dtype)
    metal = sl.brdf.metallic_roughness(wi, wo, color, 1.0, 0.5)
    assert metal.dtype == dtype
    assert np.allclose(metal, sl.brdf.ggx(wi, wo, 0.25, color), rtol=8 * np.finfo(dtype).eps)
    diffuser = sl.brdf.metallic_roughness(wi, wo, color, 0.0, 0.5, specular=0.0)
    assert np.allclose(diffuser, sl.brdf.lambert(wi, wo, color), rtol=8 * np.finfo(dtype).eps)
    # In between it is the mix of both ends.
    half = sl.brdf.metallic_roughness(wi, wo, color, 0.25, 0.5)
    base = sl.brdf.metallic_roughness(wi, wo, color, 0.0, 0.5)
    assert np.allclose(half, 0.25 * metal + 0.75 * base, rtol=16 * np.finfo(dtype).eps)


def test_the_brdf_is_reciprocal():
    wi, wo = common.directions(1000, 3), common.directions(1000, 4)
    for metallic, roughness in itertools.product([0, 0.5, 1], [0.05, 0.5, 1]):
        a = sl.brdf.metallic_roughness(wi, wo, [0.2, 0.5, 0.9], metallic, roughness)
        assert np.allclose(a, sl.brdf.metallic_roughness(wo, wi, [0.2, 0.5, 0.9], metallic, roughness), rtol=1e-14)


@pytest.mark.parametrize("roughness", [0.0, 0.1, 0.25, 0.5, 0.75, 1.0])
def test_furnace_gains_no_energy_in_any_direction(roughness):
    cosines = np.array([1e-3, 0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0])
    wo = np.array([common.at(c) for c in cosines])[:, None]
    u = sl.sampling.sobol(1 << 13, 3, seed=1)
    for metallic, specular in itertools.product([0.0, 0.5, 1.0], [0.0, 0.5, 1.0]):
        material = (WHITE, metallic, roughness, specular)
        wi = sl.brdf.metallic_roughness_sample(wo, u, *material)
        f, pdf = sl.brdf.metallic_roughness(wi, wo, *material), sl.brdf.metallic_roughness_pdf(wi, wo, *material)
        weight = np.where(pdf > 0, f[..., 0] * wi[..., 2] / np.where(pdf > 0, pdf, 1), 0)
        albedo = weight.mean(1)
        # Standard error of the mean, of which scrambled points need far less.
        assert (albedo < 1 + 3 * weight.std(1) / np.sqrt(len(u)) + 1e-9).all()
        if specular == 0 and metallic == 0:
            assert np.allclose(albedo, 1, atol=1e-12)


@pytest.mark.parametrize("metallic", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("cosine", [1.0, 0.3])
def test_density_integrates_to_one_and_samples_estimate_the_albedo(metallic, cosine):
    material = ([0.9, 0.6, 0.3], metallic, 0.5)
    wo, grid = common.at(cosine), common.sphere()
    pdf = sl.brdf.metallic_roughness_pdf(grid, wo, *material)
    assert pdf.mean() * 4 * np.pi == pytest.approx(1, abs=1e-4)
    albedo = (sl.brdf.metallic_roughness(grid, wo, *material) * np.maximum(grid[:, 2:], 0)).mean(0) * 4 * np.pi
    wi = sl.brdf.metallic_roughness_sample(wo, sl.sampling.sobol(1 << 16, 3), *material)
    weight = sl.brdf.metallic_roughness(wi, wo, *material) * wi[:, 2:]
    weight /= sl.brdf.metallic_roughness_pdf(wi, wo, *material)[:, None]
    # Both quadratures are good to 1e-3 here.
    assert np.allclose(weight.mean(0), albedo, rtol=2e-3)


def test_elements_out_of_domain_give_nan_and_touch_no_other():
    up = [0.0, 0.0, 1.0]
    f = sl.brdf.metallic_roughness(up, up, [WHITE, [2.0, 1, 1], WHITE, WHITE], np.array([0, 0, 1.5, np.nan]), 0.5)
    assert np.array_equal(np.isnan(f).any(-1), [False, True, True, True])
    with pytest.raises(ValueError, match=r"roughness: expected a number in \[0, 1\], got -1"):
        sl.brdf.metallic_roughness(up, up, WHITE, 0.0, -1.0)
    with pytest.raises(ValueError, match=r"base_color: expected shape \(\.\.\., 3\)"):
        sl.brdf.metallic_roughness(up, up, [1.0, 1.0])
