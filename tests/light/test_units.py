"""Fluxes and intensities against quadrature over directions; photometric units and back."""

import numpy as np
import pytest
import shadelab as sl

L = sl.light
LIGHTS = [
    L.PointLight((0, 1, 0), (1, 2, 3)),
    L.SpotLight((0, 1, 0), (0, -1, 1), (1, 2, 3), 0.4, 1.1),
    L.SpotLight((0, 1, 0), (0, -1, 1), (1, 2, 3), np.pi, np.pi),
    L.RectLight((0, 0, 0), (1, 0, 0), (0, 2, 0), (1, 2, 3)),
    L.RectLight((0, 0, 0), (1, 0, 0), (0, 2, 0), (1, 2, 3), two_sided=True),
    L.DiskLight((0, 0, 0), (1, 1, 0), 0.7, (1, 2, 3)),
    L.SphereLight((0, 0, 0), 0.7, (1, 2, 3)),
    L.PolygonLight([[0, 0, 0], [1, 0, 0], [0, 2, 0]], (1, 2, 3)),
]


@pytest.mark.parametrize("light", LIGHTS, ids=lambda light: type(light).__name__)
def test_flux_is_the_integral_of_intensity(light):
    n = 800
    z = 1 - 2 * (np.arange(n) + 0.5) / n
    azimuth = 2 * np.pi * (np.arange(n) + 0.5) / n
    r = np.sqrt(1 - z * z)[:, None]
    w = np.stack(np.broadcast_arrays(r * np.cos(azimuth), r * np.sin(azimuth), z[:, None]), -1)
    got = L.intensity(light, w).mean((0, 1)) * 4 * np.pi
    # 640,000 directions over kinks.
    assert np.allclose(got, L.flux(light), rtol=2e-3)


@pytest.mark.parametrize("light", LIGHTS[3:], ids=lambda light: type(light).__name__)
def test_far_away_irradiance_is_intensity_over_distance_squared(light):
    w = np.array([0.48, 0.6, 0.64])
    distance = 1e3
    got = L.irradiance(light, w * distance, -w) * distance**2
    assert np.allclose(got, L.intensity(light, w), rtol=5e-3)


def test_photometric_units_and_back():
    values = np.random.default_rng(1).uniform(0, 2, (10, 3))
    lumens = L.photometric(values)
    assert np.allclose(lumens, 683 * sl.color.luminance(values))
    back = L.radiometric(lumens, values)
    assert np.allclose(back, values)
    assert L.photometric(values.astype(np.float32)).dtype == np.float32
    assert L.photometric([1.0, 1, 1], efficacy=179.0) == pytest.approx(179)


@pytest.mark.parametrize("light", LIGHTS, ids=lambda light: type(light).__name__)
def test_lights_of_a_given_flux(light):
    bulb = L.with_flux(light, L.radiometric(800.0, (1.0, 0.8, 0.6)))
    assert L.photometric(L.flux(bulb)) == pytest.approx(800)
    assert type(bulb) is type(light)


def test_what_has_no_flux_is_refused():
    for light in (L.DirectionalLight((0, -1, 0)), L.AmbientLight()):
        with pytest.raises(TypeError, match="light: expected a light with a place"):
            L.flux(light)
        with pytest.raises(TypeError, match="light: expected a light with a place"):
            L.with_flux(light, 1.0)
    with pytest.raises(ValueError, match="light: expected one that can send"):
        L.with_flux(L.SpotLight((0, 0, 0), (0, 1, 0), outer_angle=0.0), 1.0)
    with pytest.raises(ValueError, match="color: expected a colour that is not black"):
        L.radiometric(1.0, (0.0, 0.0, 0.0))


@pytest.mark.parametrize("length", [1e-300, 1.0, 1e300])
def test_axes_of_any_length_have_their_intensity(length):
    spot = sl.light.SpotLight((0, 2, 0), (0, -length, 0))
    disk = sl.light.DiskLight((0, 2, 0), (0, -length, 0), 1.0)
    assert np.allclose(sl.light.intensity(spot, [0.0, -1, 0]), spot.intensity)
    assert np.allclose(sl.light.intensity(disk, [0.0, -1, 0]), np.pi * np.asarray(disk.radiance))


@pytest.mark.parametrize("size", [1e160, 1e25, 1e-25])
def test_polygons_beyond_the_sizes_of_lights_are_refused(size):
    with pytest.raises(ValueError, match="corners: expected a polygon of 1e-15 to 1e"):
        sl.light.PolygonLight([[0, 0, 0], [size, 0, 0], [0, size, 0]])
