"""Maps of moments: what they hold, against sums written out; what a lookup reads of them; what 16 bits lose."""

import numpy as np
import pytest
import scipy.ndimage
import shadelab as sl

UP = [0, 1, 0]
SHADOW = sl.shadow


def random_map(n=64, dtype=np.float64, empty=0.0):
    """A map from 4 above the ground with depths from 2 to 4, and a share of empty texels."""
    rng = np.random.default_rng(1)
    depth = rng.uniform(2, 4, (n, n))
    depth[0, 0], depth[0, 1] = 2, 4
    depth[rng.random((n, n)) < empty] = np.inf
    down = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
    near, far = depth[np.isfinite(depth)].min(), depth[np.isfinite(depth)].max()
    return SHADOW.ShadowMap(depth.astype(dtype), "perspective", [0, 4, 0], down, [-1, 1, -1, 1], near, far)


def basis(depth, kind, near=2.0, far=4.0):
    z = np.clip((depth - (near + far) / 2) / ((far - near) / 2), -1, 1)
    if kind == "variance":
        return np.stack([z, z**2], -1)
    if kind == "moment":
        return np.stack([z, z**2, z**3, z**4], -1)
    e, f = np.exp(7 * z), -np.exp(-3 * z)
    return np.stack([e, e**2, f, f**2], -1)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("kind", ["variance", "exponential_variance", "moment"])
@pytest.mark.parametrize("reduce", [1, 4, 5])
def test_holds_the_means_of_its_basis(dtype, kind, reduce):
    m = random_map(dtype=dtype)
    own = {"exponents": (7.0, 3.0)} if kind == "exponential_variance" else {}
    moments = SHADOW.moment_map(m, kind, filter="none", reduce=reduce, **own).moments
    assert moments.dtype == dtype
    b = basis(m.depth.astype(np.float64), kind)
    cells = [
        np.add.reduceat(np.add.reduceat(w, range(0, 64, reduce), 0), range(0, 64, reduce), 1) for w in (b, 1 + 0 * b)
    ]
    # e^14 is a million: relative to the largest, with a rounding of z magnified by the exponent.
    np.testing.assert_allclose(moments, cells[0] / cells[1], rtol=0, atol=40 * np.finfo(dtype).eps * np.abs(b).max())


def test_empty_texels_lie_behind_all_that_is_looked_up():
    m = random_map(empty=0.5)
    assert SHADOW.moment_map(m).far == pytest.approx(6.0, abs=0.01)
    fitted = SHADOW.moment_map(m, filter="none", receivers=[[0.0, -1.0, 0.0]])
    assert 5.0 < fitted.far < 5.01
    assert (fitted.moments[np.isinf(m.depth)] == 1).all()
    assert (fitted.moments[np.isfinite(m.depth), 0] < 1).all()
    assert fitted.depth_of([-1.0, 1.0]) == pytest.approx([fitted.near, fitted.far])


def read(m, at, radius=None):
    """The moments that a lookup reads over places given in texels."""
    x = (np.asarray(at) / 64 * 2 - 1) * 4
    points = np.stack([x[:, 0], 0 * x[:, 0], x[:, 1]], -1)
    f = SHADOW.variance if m.kind == "variance" else SHADOW.moment
    return f(m, points, radius=radius, full_output=True).moments


def test_a_table_gives_the_mean_over_the_very_box():
    m = random_map()
    table = SHADOW.moment_map(m, "variance", filter="summed_area")
    b = basis(m.depth, "variance")
    rng = np.random.default_rng(2)
    at = rng.uniform(0, 64, (200, 2))
    for radius in (0.5, 1.3, 7.0, 20.0):
        got = read(table, at, radius)
        edges = np.arange(64)
        for (x, y), moments in zip(at, got, strict=True):
            # Each texel counts by the share of it that the box covers; the box ends with the map.
            wx = np.clip(np.minimum(edges + 1, x + radius) - np.maximum(edges, x - radius), 0, 1)
            wy = np.clip(np.minimum(edges + 1, y + radius) - np.maximum(edges, y - radius), 0, 1)
            if wx.sum() < 1 or wy.sum() < 1:
                continue
            weights = wy[:, None] * wx
            exact = (weights[..., None] * b).sum((0, 1)) / weights.sum()
            np.testing.assert_allclose(moments, exact, rtol=0, atol=1e-11)


def test_a_gaussian_is_read_between_texels():
    m = random_map()
    filtered = SHADOW.moment_map(m, "variance", sigma=1.5)
    blurred = scipy.ndimage.gaussian_filter(basis(m.depth, "variance"), (1.5, 1.5, 0), mode="nearest", truncate=3.0)
    at = np.random.default_rng(3).uniform(1, 63, (100, 2))
    exact = [
        scipy.ndimage.map_coordinates(blurred[..., c], [at[:, 1] - 0.5, at[:, 0] - 0.5], order=1) for c in range(2)
    ]
    np.testing.assert_allclose(read(filtered, at), np.stack(exact, -1), atol=1e-12)


def test_mips_have_the_mean_of_the_map_at_the_top_and_its_texels_below():
    m = random_map()
    chain = SHADOW.moment_map(m, filter="mip")
    b = basis(m.depth, "moment")
    np.testing.assert_allclose(read(chain, [[30.0, 20.0]], 1e6), [b.mean((0, 1))], rtol=1e-12)
    np.testing.assert_allclose(read(chain, [[30.5, 20.5]], 0.0), [b[20, 30]], rtol=1e-12)


def test_the_kernel_of_a_mip_has_the_variance_of_the_box():
    """Over all places of an edge on the mips' grid, on which their kernel depends."""
    spread = {"mip": [], "summed_area": []}
    x = np.linspace(8, 56, 385)
    for edge in range(28, 36):
        depth = np.where(np.arange(64) < edge, 2.0, 4.0)[None].repeat(64, 0)
        down = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
        m = SHADOW.ShadowMap(depth, "perspective", [0, 4, 0], down, [-1, 1, -1, 1], 2.0, 4.0)
        for filter, found in spread.items():
            filtered = SHADOW.moment_map(m, "variance", filter=filter)
            slope = np.gradient(read(filtered, np.stack([x, 0 * x + 32], -1), 6.0)[:, 0], x)
            found.append((slope * (x - edge) ** 2).sum() / slope.sum())
    assert np.mean(spread["summed_area"]) == pytest.approx(12, rel=0.02)
    # Between two levels the mean of two kernels: a little wider than one of the mean width.
    assert np.mean(spread["mip"]) == pytest.approx(12, rel=0.25)


def test_16_bits_are_within_half_a_step_of_the_transform():
    m = random_map()
    exact, whole = (SHADOW.moment_map(m, sigma=1.0, bits=bits) for bits in (None, 16))
    assert whole.moments.dtype == np.uint16 and whole.bytes * 4 == exact.bytes
    at = np.stack(np.meshgrid(np.arange(2, 60) + 0.5, np.arange(2, 60) + 0.5), -1).reshape(-1, 2)
    off = np.abs(read(whole, at) - read(exact, at)).max(0)
    # Half a step of 1/65535 through the inverse transform: rows' sums are 2.07, 1.125, 2.05, 1.125.
    assert (off <= np.array([2.1, 1.2, 2.1, 1.2]) * 0.5 / 65535).all()
    assert off.max() > 1e-6


def test_what_each_precision_of_a_table_loses():
    m = random_map(512, np.float32)
    at = np.random.default_rng(4).uniform(4, 60, (500, 2))
    tables = {
        p: SHADOW.moment_map(m, "variance", filter="summed_area", precision=p)
        for p in ("double", "compensated", "single")
    }
    assert tables["double"].moments.dtype == np.float64 and tables["single"].moments.dtype == np.float32
    moments = {p: read(t, at, 2.0) for p, t in tables.items()}
    lost = {p: np.abs(moments[p] - moments["double"]).max() for p in ("compensated", "single")}
    # Sums of both signs stay small, so that plain ones lose no more here: see `summed_area_table` for positive numbers.
    assert 1e-5 < min(lost.values()) and max(lost.values()) < 0.05


def test_the_same_for_any_number_of_threads():
    m = random_map(200, np.float32)
    results = []
    for n in (1, 2, 3):
        sl.set_threads(n)
        results.append([SHADOW.moment_map(m, filter=f).moments for f in ("gaussian", "mip", "summed_area")])
    sl.set_threads(None)
    for other in results[1:]:
        assert all(np.array_equal(a, b) for a, b in zip(results[0], other, strict=True))


def test_errors_name_the_argument():
    m = random_map(256, np.float32)
    wrong = [
        ("shadow_map", TypeError, (m.depth,), {}),
        ("kind", ValueError, (m, "mean"), {}),
        ("filter", ValueError, (m,), {"filter": "box"}),
        ("sigma", ValueError, (m,), {"sigma": -1}),
        ("sigma", ValueError, (m,), {"sigma": 2.0, "filter": "mip"}),
        ("precision", ValueError, (m,), {"precision": "single"}),
        ("exponents", ValueError, (m,), {"exponents": 5.0}),
        ("receivers", ValueError, (m,), {"receivers": [[np.nan] * 3]}),
        ("reduce", ValueError, (m,), {"reduce": 0}),
        ("reduce", ValueError, (m,), {"reduce": 257}),
        ("bits", ValueError, (m,), {"bits": 8}),
        ("bits", ValueError, (m, "variance"), {"bits": 16}),
        ("bits", ValueError, (m,), {"bits": 16, "filter": "summed_area"}),
        ("exponents", ValueError, (m, "exponential_variance"), {"exponents": 43}),
        ("exponents", ValueError, (m, "exponential_variance"), {"exponents": (1, 2, 3)}),
        ("exponents", ValueError, (m, "exponential_variance"), {"exponents": 0}),
        (
            "exponents",
            ValueError,
            (m, "exponential_variance"),
            {"exponents": 42, "filter": "summed_area", "precision": "single"},
        ),
        ("precision", ValueError, (m,), {"precision": "half"}),
        ("receivers", ValueError, (m,), {"receivers": [1.0, 2.0]}),
    ]
    for name, error, args, kwargs in wrong:
        with pytest.raises(error, match=name):
            SHADOW.moment_map(*args, **kwargs)
