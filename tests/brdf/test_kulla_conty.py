"""Energy compensation: the table, the furnace, the two colours."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from shadelab import brdf

spec = importlib.util.spec_from_file_location("brdf_common", Path(__file__).with_name("common.py"))
common = importlib.util.module_from_spec(spec)
spec.loader.exec_module(common)

WHITE = {"eta": 1e-9, "k": 1e9}


@pytest.mark.parametrize(("roughness", "loss"), [(0.25, 1.3), (0.5, 11.8), (0.75, 34.4), (1.0, 59.0)])
def test_single_bounces_lose_what_is_known(roughness, loss):
    """Cosine-averaged, in per cent; to the last digit given, plus the table's and the draws' error."""
    model = brdf.RoughConductor(roughness**2, **WHITE)
    assert 100 * brdf.white_furnace(model)[0] == pytest.approx(loss, abs=0.1)


def test_along_the_normal_the_roughest_loses_most():
    albedo = brdf.directional_albedo(brdf.RoughConductor(1.0, **WHITE), [0.0, 0.0, 1.0], 1 << 16)
    assert 100 * (1 - albedo[0]) == pytest.approx(69.3, abs=0.05)


@pytest.mark.parametrize("roughness", [0.1, 0.25, 0.4, 0.5, 0.75, 0.9, 1.0])
@pytest.mark.parametrize("compensation", ["kulla_conty", "kulla_conty_as_published", "scaled"])
def test_compensated_mirrors_give_all_back(roughness, compensation):
    model = brdf.RoughConductor(roughness**2, **WHITE, compensation=compensation)
    assert abs(brdf.white_furnace(model)).max() < 0.002


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
def test_other_facets_are_compensated_too(distribution):
    model = brdf.RoughConductor(
        0.5, **WHITE, distribution=distribution, masking="separable", compensation="kulla_conty"
    )
    assert abs(brdf.white_furnace(model, samples=1 << 15)).max() < 0.004


@pytest.mark.parametrize(("alpha_y", "left"), [(0.5, 0.006), (0.1, 0.022)])
def test_of_two_widths_little_loss_is_left(alpha_y, left):
    """By the mean of the widths that directions about see; by the geometric mean 4 and 25 % were."""
    x, weight = np.polynomial.legendre.leggauss(16)
    cosine, turn = ((x + 1) / 2)[:, None], (np.arange(8) + 0.5) * np.pi / 16
    s = np.sqrt(1 - cosine**2)
    wo = np.stack(np.broadcast_arrays(s * np.cos(turn), s * np.sin(turn), cosine), -1)
    model = brdf.RoughConductor(1.0, **WHITE, alpha_y=alpha_y, compensation="kulla_conty")
    albedo = brdf.directional_albedo(model, wo, 2048)[..., 0].mean(1)
    assert -0.002 < 1 - (albedo * weight * cosine[:, 0]).sum() < left


def test_the_table_holds_the_albedo():
    table = brdf.albedo_table()
    for row in (15, 31):
        for column in (3, 10, 31):
            wo = common.at(table.knots[column])
            albedo = brdf.directional_albedo(brdf.RoughConductor(table.knots[row], **WHITE), wo, 1 << 15)[0]
            assert table.albedo[row, column] == pytest.approx(albedo, abs=1e-3)


def test_colours():
    """Bounces: F²E / (1 − F(1 − E)) is the sum over two and more; what was published has a factor F less."""
    up = [0.0, 0.0, 1.0]
    f = np.array([0.3, 0.9, 1.0])
    own = brdf.kulla_conty(up, up, 0.8, f, full_output=True)
    e = own.average
    series = sum(f ** (k + 1) * (1 - e) ** (k - 1) * e for k in range(1, 400))
    np.testing.assert_allclose(own.color, series, rtol=1e-9)
    first = brdf.kulla_conty(up, up, 0.8, f, color="as_published", full_output=True)
    np.testing.assert_allclose(first.color * f, own.color, rtol=1e-12)
    assert (first.color[:2] > own.color[:2]).all() and first.color[2] == pytest.approx(1)


def test_the_model_is_the_sum_of_its_parts():
    wi, wo = common.directions(100, 1), common.directions(100, 2)
    eta, k = (0.2, 0.92, 1.1), (3.91, 2.45, 2.14)
    whole = brdf.RoughConductor(0.6, eta, k, compensation="kulla_conty")
    once = brdf.RoughConductor(0.6, eta, k)
    averages = brdf.fresnel_average(np.array(eta), np.array(k))
    lobe = np.stack([brdf.kulla_conty(wi, wo, 0.6, f) for f in averages], -1)
    np.testing.assert_allclose(whole.eval(wi, wo), once.eval(wi, wo) + lobe, rtol=1e-12)
    np.testing.assert_allclose(whole.eval(wi, wo), whole.eval(wo, wi), rtol=1e-12)


@pytest.mark.parametrize("compensation", ["kulla_conty", "scaled"])
def test_draws_follow_the_density(compensation):
    model = brdf.RoughConductor(0.8, compensation=compensation)
    assert common.samples_follow(model, common.at(0.6)) > 1e-4
    assert common.total(lambda w: model.pdf(w, common.at(0.6))) == pytest.approx(1, abs=1e-3)


@pytest.mark.parametrize("compensation", ["kulla_conty", "scaled"])
@pytest.mark.parametrize("roughness", [0.0, 0.25, 0.5, 0.75, 1.0])
def test_white_metal_of_the_real_time_material_gives_all_back(roughness, compensation):
    model = brdf.MetallicRoughness(1.0, 1.0, roughness, compensation=compensation)
    assert abs(brdf.white_furnace(model)).max() < 0.002
    plain = brdf.MetallicRoughness(1.0, 1.0, roughness)
    assert roughness < 0.3 or brdf.white_furnace(plain).min() > 0.1


@pytest.mark.parametrize("metallic", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("roughness", [0.1, 0.5, 1.0])
def test_the_real_time_material_gives_back_no_more_than_came(metallic, roughness):
    wo = np.stack([common.at(c) for c in (1.0, 0.7, 0.4, 0.1)])
    model = brdf.MetallicRoughness((1.0, 0.5, 0.04), metallic, roughness, compensation="kulla_conty")
    plain = brdf.MetallicRoughness((1.0, 0.5, 0.04), metallic, roughness)
    albedo, before = (brdf.directional_albedo(m, wo, 1 << 15) for m in (model, plain))
    # The table's and the draws' error.
    assert albedo.max() < 1.003 and (albedo >= before - 1e-3).all()
    if metallic == 0:
        assert (albedo - before).max() < 0.004
    wi, wo = common.directions(300, 3), common.directions(300, 4)
    np.testing.assert_allclose(model.eval(wi, wo), model.eval(wo, wi), rtol=1e-11)


def test_the_real_time_metal_is_schlicks_share_of_the_rough_conductor():
    """At F = 1 both are the same mirrors."""
    wi, wo = common.directions(200, 5), common.directions(200, 6)
    metal = brdf.MetallicRoughness(1.0, 1.0, 0.8, compensation="kulla_conty")
    white = brdf.RoughConductor(0.64, **WHITE, compensation="kulla_conty")
    np.testing.assert_allclose(metal.eval(wi, wo), white.eval(wi, wo), rtol=2e-6)


@pytest.mark.parametrize("compensation", ["kulla_conty", "scaled"])
@pytest.mark.parametrize("metallic", [0.2, 1.0])
def test_draws_of_the_real_time_material_follow_the_density(metallic, compensation):
    model = brdf.MetallicRoughness(0.7, metallic, 0.9, compensation=compensation)
    assert common.samples_follow(model, common.at(0.6)) > 1e-4
    assert common.total(lambda w: model.pdf(w, common.at(0.6))) < 1 + 1e-3


@pytest.mark.parametrize("alpha", [1e-6, 1e-4, 1e-3, 1e-2])
@pytest.mark.parametrize("cosine", [1e-7, 1e-3, 0.1, 1.0])
@pytest.mark.parametrize("compensation", ["kulla_conty", "scaled"])
def test_sharp_mirrors_are_given_no_more_than_came(alpha, cosine, compensation):
    """Smooth mirrors lose nothing. The lobe is even in azimuth and lies at grazing, where few draws fall."""
    wo = np.array([np.sqrt(1 - cosine**2), 0, cosine])
    once = brdf.RoughConductor(alpha, **WHITE)
    model = brdf.RoughConductor(alpha, **WHITE, compensation=compensation)
    if compensation == "scaled":
        albedo = brdf.directional_albedo(model, wo, 1 << 12)[0]
    else:
        t = (np.arange(1 << 14) + 0.5) / (1 << 14)
        wi = np.stack([0 * t, np.sqrt(1 - t**4), t * t], -1)
        added = (model.eval(wi, wo) - once.eval(wi, wo))[:, 0]
        albedo = brdf.directional_albedo(once, wo, 1 << 12)[0] + (added * 4 * np.pi * t**3).mean()
    assert 0.94 < albedo < 1.012
