"""Transformed cosines: lobes that are densities, magnitudes that are GGX's, light near that of the exact lobe.

`python tests/light/test_ltc.py fit` fits the shipped table anew, about ten seconds, and writes it for the next build.
"""

import sys
from pathlib import Path

import numpy as np
import pytest
import shadelab as sl

L = sl.light
FLOATS = [np.float32, np.float64]
RECT = L.RectLight((0.3, 1.5, -0.5), (1.4, 0, 0), (0, 0, 1.0), (3, 2, 1))
TABLE = L.LtcTable.shipped()


def eye(cosine):
    return np.array([np.sqrt(1 - cosine**2), cosine, 0.0])


def sphere(n):
    """Directions about +z, even in solid angle, and what each stands for."""
    z = 1 - 2 * (np.arange(n) + 0.5) / n
    azimuth = 2 * np.pi * (np.arange(n) + 0.5) / n
    r = np.sqrt(1 - z * z)[:, None]
    return np.stack(np.broadcast_arrays(r * np.cos(azimuth), r * np.sin(azimuth), z[:, None]), -1), 4 * np.pi / n**2


@pytest.mark.parametrize("at", [(31, 0), (31, 31), (16, 20), (10, 5)])
def test_lobes_are_densities(at):
    w, weight = sphere(1500)
    for m in TABLE.inverse[at].astype(float):
        assert density(m, w).sum() * weight == pytest.approx(1, rel=2e-3)


def density(m, w):
    """Of a cosine lobe that the inverse of `m` has sheared."""
    v = w @ m.T
    return np.maximum(v[..., 2], 0) * np.linalg.det(m) / (np.pi * (v**2).sum(-1) ** 2)


@pytest.mark.parametrize(("row", "column"), [(31, 0), (20, 0), (31, 25), (12, 16), (6, 10)])
def test_magnitudes_are_those_of_ggx(row, column):
    alpha, cosine = (row / 31) ** 2, 1 - (column / 31) ** 2
    wo = np.array([np.sqrt(1 - cosine**2), 0, cosine])
    wi = sl.brdf.ggx_sample(wo, sl.sampling.sobol(1 << 14, 2), alpha)
    pdf = sl.brdf.ggx_pdf(wi, wo, alpha)
    value = sl.brdf.ggx(wi, wo, alpha, [1.0] * 3)[:, 0] * wi[:, 2]
    share = np.divide(value, pdf, out=np.zeros(len(wi)), where=(wi[:, 2] > 0) & (pdf > 0))
    half = (wi + wo) / np.linalg.norm(wi + wo, axis=-1, keepdims=True)
    # The average of 2^14 points is good to 2e-4; the fit's own rule crowds its points in the lobe's long tail.
    assert TABLE.magnitude[row, column].sum() == pytest.approx(share.mean(), abs=3e-4)
    grazing = (share * (1 - (wi * half).sum(-1)) ** 5).mean()
    assert TABLE.grazing[row, column].sum() == pytest.approx(grazing, abs=3e-4)


# Half of ∫ |f − g| dω of both lobes as densities, at roughness 0.25, 0.5, 0.75, 1 and 0, 30, 60, 75, 85 degrees.
VARIATION = np.array(
    [
        [0.002, 0.002, 0.018, 0.056, 0.155],
        [0.012, 0.014, 0.033, 0.058, 0.092],
        [0.006, 0.010, 0.022, 0.033, 0.052],
        [0.006, 0.006, 0.010, 0.014, 0.025],
    ]
)


@pytest.mark.parametrize("row", range(4))
def test_the_lobes_error_is_as_measured(row):
    alpha = ((row + 1) / 4) ** 2
    for column, degrees in enumerate((0, 30, 60, 75, 85)):
        wo = np.array([np.sin(np.radians(degrees)), 0, np.cos(np.radians(degrees))])
        w, _ = sphere(1000)
        up = w[..., 2] > 0
        f = np.where(up, sl.brdf.ggx(w, wo, alpha)[..., 0] * w[..., 2], 0)
        g = sum(
            share * (part := np.where(up, density(m, w), 0)) / part.sum()
            for m, share in zip(*pair(alpha, wo[2]), strict=True)
        )
        error = np.abs(f / f.sum() - g / g.sum()).sum() / 2
        assert error == pytest.approx(VARIATION[row, column], abs=0.003)


def pair(alpha, cosine):
    """The table's inverse matrices and magnitudes, between four of the grid."""
    s, t = 31 * np.sqrt(alpha), 31 * np.sqrt(1 - cosine)
    i, j = min(int(s), 30), min(int(t), 30)
    s, t = s - i, t - j

    def between(x):
        return (x[i, j] * (1 - t) + x[i, j + 1] * t) * (1 - s) + (x[i + 1, j] * (1 - t) + x[i + 1, j + 1] * t) * s

    m = TABLE.inverse.astype(float).copy()
    m[..., 2, :] /= np.maximum(np.linspace(0, 1, 32) ** 2, 1e-4)[:, None, None, None]
    m = between(m)
    m[:, 2] *= alpha
    return m, between(TABLE.magnitude.astype(float))


def test_the_shipped_table_is_what_the_fit_gives():
    """Of its last row, from which the others go on; magnitudes are those of GGX, whatever the fit."""
    fitted = L.fit_ltc((2, 32))
    assert np.array_equal(fitted.magnitude[1], TABLE.magnitude[31])
    assert np.array_equal(fitted.inverse[1], TABLE.inverse[31])
    assert np.allclose(fitted.magnitude[0].sum(-1), TABLE.magnitude[0].sum(-1), rtol=1e-6)
    # A mirror of alpha 1e-4 seen from 0.06 degrees above its plane is beyond the pair.
    assert fitted.distance[:, :-1].max() < 0.2


@pytest.mark.parametrize("dtype", FLOATS)
@pytest.mark.parametrize("roughness", [0.2, 0.4, 0.7, 1.0])
def test_light_is_near_that_of_the_exact_lobe(roughness, dtype):
    """Relative to the brightest of the picture: that is what is seen."""
    x, z = np.meshgrid(np.linspace(-2, 2, 24), np.linspace(-2, 2, 24))
    points = np.stack([x, 0 * x, z], -1).astype(dtype)
    up = np.array([0, 1, 0], dtype)
    position = np.array([1.0, 1.2, 2.5])
    wo = position - points
    wo = (wo / np.linalg.norm(wo, axis=-1, keepdims=True)).astype(dtype)
    material = dict(metallic=1.0, roughness=roughness, wo=wo)
    exact = L.unshadowed(RECT, points, up, [0.9, 0.6, 0.3], samples=1024, **material)
    got = L.unshadowed(RECT, points, up, [0.9, 0.6, 0.3], method="ltc", **material)
    assert got.dtype == dtype
    # Measured of white at these roughnesses: root mean square 0.0005, 0.003, 0.006, 0.0035, largest 0.006, 0.015, 0.03,
    # 0.021.
    assert np.abs(got - exact).max() / exact.max() < 0.035
    assert np.sqrt(((got - exact) ** 2).mean()) / exact.max() < 0.008
    direct = L.ltc(RECT, points, up, wo, roughness**2, [0.9, 0.6, 0.3])
    assert np.allclose(direct, got, rtol=0, atol=float(1e-5 * exact.max()))


def test_a_light_all_around_gives_the_magnitude():
    ceiling = L.RectLight((0, 1, 0), (2e4, 0, 0), (0, 0, 2e4))
    up = np.array([0.0, 1, 0])
    for row, column in ((4, 0), (16, 0), (31, 0), (16, 16), (31, 16)):
        alpha, cosine = (row / 31) ** 2, 1 - (column / 31) ** 2
        full = L.ltc(ceiling, [0.0, 0, 0], up, eye(cosine), alpha, full_output=True)
        # What the approximation's lobe has below the horizon does not count; the ceiling ends 1e-4 above it.
        assert full.base / TABLE.magnitude[row, column].sum() == pytest.approx(1, abs=1e-3)


def test_horizons_backs_and_bad_elements():
    up = np.array([0.0, 1, 0])
    below = L.RectLight((0, -1, 0), (1, 0, 0), (0, 0, -1))
    assert L.ltc(below, [0.0, 0, 0], up, up, 0.3).max() == 0
    behind = L.RectLight((0, 1, 0), (0, 0, 1), (1, 0, 0))
    assert L.ltc(behind, [0.0, 0, 0], up, up, 0.3).max() == 0
    both = L.RectLight((0, 1, 0), (0, 0, 1), (1, 0, 0), two_sided=True)
    front = L.RectLight((0, 1, 0), (1, 0, 0), (0, 0, 1))
    assert np.allclose(L.ltc(both, [0.0, 0, 0], up, up, 0.3), L.ltc(front, [0.0, 0, 0], up, up, 0.3))
    got = L.ltc(front, [[np.nan, 0, 0], [0.0, 0, 0]], up, up, [0.3, 0.3])
    assert np.isnan(got[0]).all() and np.isfinite(got[1]).all()
    assert np.isnan(L.ltc(front, [0.0, 0, 0], up, up, [0.0, 1.5])).all()
    assert L.ltc(front, [0.0, 0, 0], up, -up, 0.3).max() == 0
    upright = L.RectLight((0, 0, -1), (1, 0, 0), (0, 1, 0))
    half = L.RectLight((0, 0.25, -1), (1, 0, 0), (0, 0.5, 0))
    # What lies below the horizon counts for nothing.
    assert np.allclose(L.ltc(upright, [0.0, 0, 0], up, eye(0.5), 0.3), L.ltc(half, [0.0, 0, 0], up, eye(0.5), 0.3))


def test_round_lights_are_near_their_exact_lobe():
    up, wo = np.array([0.0, 1, 0]), eye(0.7)
    for light in (L.DiskLight((-0.5, 1, 0), (0, -1, 0), 0.5), L.SphereLight((-0.5, 1, 0), 0.5)):
        exact = L.unshadowed(light, [0.0, 0, 0], up, [1.0] * 3, 1.0, 0.5, wo=wo, samples=4096)[0]
        assert L.ltc(light, [0.0, 0, 0], up, wo, 0.25)[0] == pytest.approx(exact, rel=0.08)


def test_bad_arguments_are_refused_by_name():
    with pytest.raises(TypeError, match="light: expected a light with an outline, got PointLight"):
        L.ltc(L.PointLight((0, 1, 0)), [0.0, 0, 0], [0.0, 1, 0], [0.0, 1, 0], 0.5)
    with pytest.raises(ValueError, match="size: expected an integer"):
        L.fit_ltc((1, 4))
    with pytest.raises(ValueError, match="method: expected one of"):
        L.unshadowed(RECT, [0.0, 0, 0], [0.0, 1, 0], [1.0] * 3, wo=[0.0, 1, 0], method="best")


if __name__ == "__main__" and sys.argv[1:] == ["fit"]:
    rows = L.fit_ltc(progress=True)._lobes()[0]
    text = "".join(" ".join(str(x) for x in row) + "\n" for row in rows)
    (Path(__file__).parents[2] / "src/light/ltc/table_data.txt").write_text(text)


def test_tables_that_are_none_are_refused():
    def table(rows, columns, **changes):
        parts = {
            "inverse": np.ones((rows, columns, 2, 3, 3)),
            "magnitude": np.ones((rows, columns, 2)),
            "grazing": np.ones((rows, columns, 2)),
            "distance": np.ones((rows, columns)),
        }
        return sl.light.LtcTable(**(parts | changes))

    assert table(2, 2).magnitude.dtype == np.float32
    for rows, columns in [(0, 0), (1, 1), (2, 0), (4, 1)]:
        with pytest.raises(ValueError, match="magnitude"):
            table(rows, columns)
    for name in ("inverse", "magnitude", "grazing"):
        with pytest.raises(ValueError, match=name):
            table(2, 3, **{name: np.full((2, 3, 2, 3, 3)[: 5 if name == "inverse" else 3], np.nan)})
    with pytest.raises(ValueError, match="distance"):
        table(2, 3, distance=np.ones(3))
