"""The other workflow: energy, and the way there and back."""

import importlib.util
from pathlib import Path

import numpy as np
from shadelab import brdf

spec = importlib.util.spec_from_file_location("brdf_common", Path(__file__).with_name("common.py"))
common = importlib.util.module_from_spec(spec)
spec.loader.exec_module(common)


def test_there_and_back():
    rng = np.random.default_rng(1)
    base = rng.random((500, 3))
    # Metals and dielectrics; between them the way is by brightness.
    for metallic in (0.0, 1.0):
        over = brdf.to_specular_glossiness(base, metallic)
        back = brdf.to_metallic_roughness(over.diffuse, over.specular)
        bright = over.specular.max(-1) > 0.1 if metallic else np.full(500, True)
        np.testing.assert_allclose(back.metallic[bright], metallic, atol=2e-2)
        np.testing.assert_allclose(back.base_color[bright], base[bright], atol=3e-2)


def test_dielectrics_look_alike():
    wi, wo = common.directions(200, 2), common.directions(200, 3)
    plain = brdf.MetallicRoughness((0.8, 0.4, 0.2), 0.0, 0.4)
    over = brdf.to_specular_glossiness((0.8, 0.4, 0.2), 0.0)
    model = brdf.SpecularGlossiness(tuple(over.diffuse), tuple(over.specular), 0.6)
    np.testing.assert_allclose(model.eval(wi, wo), plain.eval(wi, wo), rtol=1e-9)


def test_no_more_comes_back_than_came():
    wo = np.stack([common.at(c) for c in (1.0, 0.5, 0.1, 0.01)])
    for specular in (0.0, 0.04, 0.5, 1.0):
        for glossiness in (0.0, 0.5, 0.9):
            albedo = brdf.directional_albedo(brdf.SpecularGlossiness(1.0, specular, glossiness), wo, 1 << 13)
            assert albedo.max() <= 1 + 2e-3


def test_draws_follow_the_density():
    assert common.samples_follow(brdf.SpecularGlossiness(0.3, 0.5, 0.4), common.at(0.5)) > 1e-4
