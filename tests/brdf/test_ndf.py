"""Distributions of normals: unit area, known values, masking against its integral."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from shadelab import brdf

spec = importlib.util.spec_from_file_location("brdf_common", Path(__file__).with_name("common.py"))
common = importlib.util.module_from_spec(spec)
spec.loader.exec_module(common)


@pytest.mark.parametrize(
    ("distribution", "options"),
    [
        ("ggx", {}),
        ("ggx", {"alpha_y": 0.5}),
        ("beckmann", {}),
        ("beckmann", {"alpha_y": 0.5}),
        ("gtr", {"gamma": 1.0}),
        ("gtr", {"gamma": 1.5}),
        ("gtr", {"gamma": 2.0}),
        ("gtr", {"gamma": 6.0}),
    ],
)
@pytest.mark.parametrize("alpha", [0.1, 0.4, 1.0])
def test_facets_cover_the_surface(distribution, options, alpha):
    covered = common.total(lambda h: brdf.ndf(h, alpha, distribution, **options) * h[:, 2].clip(0))
    # The grid's own error at a lobe 0.1 wide.
    assert covered == pytest.approx(1, abs=5e-4)


def test_gtr_of_two_is_ggx():
    h = common.directions(100, 1)
    np.testing.assert_allclose(brdf.ndf(h, 0.3, "gtr", gamma=2.0), brdf.ndf(h, 0.3), rtol=1e-12)


def test_gtr_of_one_is_berrys():
    h, a2 = common.directions(100, 1), 0.09
    expected = (a2 - 1) / (np.pi * np.log(a2) * (1 + (a2 - 1) * h[:, 2] ** 2))
    np.testing.assert_allclose(brdf.ndf(h, 0.3, "gtr", gamma=1.0), expected, rtol=1e-12)


def test_gtr_nears_beckmann_for_narrow_widths_alone():
    """Of equal second derivative at the normal: gamma alpha_b² = alpha²."""
    gamma = 60.0

    def off(alpha):
        h = common.directions(200, 2, lowest=np.cos(np.arctan(1.5 * alpha)))
        ours = brdf.ndf(h, min(1.0, alpha * np.sqrt(gamma)), "gtr", gamma=gamma)
        return np.abs(ours / brdf.ndf(h, alpha, "beckmann") - 1).max()

    assert off(0.02) < 0.1 < off(0.5)


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("alpha", [0.2, 0.7])
@pytest.mark.parametrize("cosine", [0.9, 0.3])
def test_masking_keeps_the_projected_area(distribution, alpha, cosine):
    """What is seen of the facets is the surface as it is seen: ∫ G1 D max(0, w·h) = cos."""
    w = common.at(cosine)
    grid = common.sphere()
    g1 = brdf.masking_shadowing(w, [0.0, 0.0, 1.0], alpha, distribution, "separable")
    seen = (brdf.ndf(grid, alpha, distribution) * (grid @ w).clip(0)).mean() * 4 * np.pi
    # Walter's rational form of Beckmann's is within 0.35 %.
    assert g1 * seen == pytest.approx(cosine, rel=4e-3 if distribution == "beckmann" else 3e-4)


def test_forms_of_masking_in_order():
    wi, wo = common.directions(1000, 3), common.directions(1000, 4)
    for distribution in ("ggx", "beckmann"):
        whole = brdf.masking_shadowing(wi, wo, 0.5, distribution)
        parts = brdf.masking_shadowing(wi, wo, 0.5, distribution, "separable")
        # The rational form of Beckmann's passes one by 2e-5 before it ends.
        assert (parts <= whole + 3e-5).all() and (whole <= 1).all() and (parts >= 0).all()
    for masking in ("schlick", "v_cavity"):
        g = brdf.masking_shadowing(wi, wo, 0.5, masking=masking)
        assert (g >= 0).all() and (g <= 1).all()


def test_cook_and_torrances_grooves():
    wi, wo = common.at(0.3), common.at(0.6, np.pi)
    h = (wi + wo) / np.linalg.norm(wi + wo)
    expected = min(1, 2 * h[2] * 0.6 / (wo @ h), 2 * h[2] * 0.3 / (wo @ h))
    assert brdf.masking_shadowing(wi, wo, 0.5, masking="v_cavity") == pytest.approx(expected, rel=1e-12)


def test_domain():
    up = [0.0, 0.0, 1.0]
    assert np.isnan(brdf.ndf(up, [0.0, 1.5, np.nan])).all()
    assert not brdf.ndf([[0.6, 0, -0.8], [1.0, 0, 0]], 0.5).any()
    with pytest.raises(ValueError, match="alpha_y: GTR has one width"):
        brdf.ndf(up, 0.5, "gtr", alpha_y=0.3)
    with pytest.raises(ValueError, match="distribution: expected one of"):
        brdf.ndf(up, 0.5, "phong")
