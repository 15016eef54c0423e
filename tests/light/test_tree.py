"""The choice among many lights: chances are what they say, sum to one, and nothing that shines is left out."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats

L = sl.light
METHODS = ["uniform", "power", "tree"]
FLOATS = [np.float32, np.float64]


def lights(seed=1, count=40):
    rng = np.random.default_rng(seed)
    made = []
    for i in range(count):
        at, color = rng.uniform(-3, 3, 3), rng.gamma(0.5, 2.0, 3)
        u, v = np.linalg.qr(rng.normal(size=(3, 2)))[0].T * rng.uniform(0.1, 1, 2)[:, None]
        kinds = (
            L.PointLight(at, color),
            L.SpotLight(at, u, color, 0.2, 0.7),
            L.RectLight(at, u, v, color, two_sided=bool(rng.integers(2))),
            L.DiskLight(at, u, rng.uniform(0.1, 1), color),
            L.SphereLight(at, rng.uniform(0.05, 0.5), color),
            L.PolygonLight([at, at + u, at + v], color),
        )
        made.append(kinds[i % len(kinds)])
    return made


@pytest.mark.parametrize("dtype", FLOATS)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("surface", [False, True])
def test_chances_sum_to_one_and_are_those_of_draws(method, surface, dtype):
    many = [*lights(), L.DirectionalLight((0, -1, 0)), L.AmbientLight((0.1, 0.1, 0.1))]
    choice = L.LightSelection(many, method, scene_radius=5.0)
    rng = np.random.default_rng(2)
    points = rng.uniform(-4, 4, (50, 3)).astype(dtype)
    normals = rng.normal(size=(50, 3))
    normals = (normals / np.linalg.norm(normals, axis=-1, keepdims=True)).astype(dtype) if surface else None
    every = choice.probability(points[:, None], np.arange(len(many)), None if normals is None else normals[:, None])
    assert every.dtype == dtype
    # Some thirty factors, each rounded; the tree may lose what no light of a branch can use.
    assert (every.sum(-1) < 1 + 100 * np.finfo(dtype).eps).all()
    assert method == "tree" or np.allclose(every.sum(-1), 1, atol=100 * np.finfo(dtype).eps)
    light, p = choice.draw(points, rng.random(50).astype(dtype), normals)
    drawn = light >= 0
    assert drawn.any() and np.array_equal(p == 0, ~drawn)
    assert np.allclose(p[drawn], every[drawn, light[drawn]], rtol=1000 * np.finfo(dtype).eps)


def test_draws_follow_their_chances():
    many = lights(3)
    choice, n = L.LightSelection(many), 1 << 15
    point, normal = np.array([0.5, 0.2, -0.4]), np.array([0.0, 0.6, 0.8])
    light, _ = choice.draw(point, np.random.default_rng(1).random(n), normal)
    expected = choice.probability(point, np.arange(len(many)), normal) * n
    found = np.bincount(light[light >= 0], minlength=len(many))
    assert expected.sum() <= n * (1 + 1e-12) and found[expected == 0].sum() == 0
    rare = expected < 5
    nothing = n - expected.sum(), (light < 0).sum()
    e = np.concatenate([expected[~rare], [expected[rare].sum() + max(nothing[0], 0)]])
    f = np.concatenate([found[~rare], [found[rare].sum() + nothing[1]]])
    # At the level of 0.1 %, with a fixed seed.
    assert stats.chisquare(f[e > 0], e[e > 0] * n / e.sum()).pvalue > 1e-3


@pytest.mark.parametrize("seed", range(5))
def test_whatever_shines_may_be_drawn(seed):
    many = lights(seed)
    choice = L.LightSelection(many)
    rng = np.random.default_rng(seed)
    points, normals = rng.uniform(-4, 4, (2, 100, 3))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    every = choice.probability(points[:, None], np.arange(len(many)), normals[:, None])
    arrives = np.stack([L.irradiance(light, points, normals).max(-1) for light in many], -1)
    assert (every[arrives > 1e-9] > 0).all() and (arrives > 1e-9).any()


def test_the_tree_beats_power_where_lights_are_spread_out():
    """Variance of the estimate of irradiance from a hundred small lights along a street, by one light drawn."""
    many = [L.PointLight((float(x), 3.0, 0.0), (1, 1, 1)) for x in range(-50, 50)]
    points = np.stack([np.linspace(-40, 40, 64), np.zeros(64), np.zeros(64)], -1)
    up = np.array([0.0, 1, 0])
    arrives = np.stack([L.irradiance(light, points, up)[:, 0] for light in many], -1)
    spread = {}
    for method in METHODS:
        p = L.LightSelection(many, method).probability(points[:, None], np.arange(100), up)
        spread[method] = ((arrives**2 / p).sum(-1) - arrives.sum(-1) ** 2).mean()
    assert spread["power"] == pytest.approx(spread["uniform"])
    assert spread["tree"] < 0.3 * spread["power"]


def test_lights_that_turn_away_or_are_black_are_not_drawn():
    away = L.RectLight((0, 1, 0), (0, 0, 1), (1, 0, 0))
    below, black = L.PointLight((0, -1, 0)), L.PointLight((0, 1, 0), (0, 0, 0))
    good = L.PointLight((0, 2, 0))
    choice = L.LightSelection([away, below, black, good])
    p = choice.probability([0.0, 0, 0], np.arange(4), [0.0, 1, 0])
    assert np.array_equal(p, [0, 0, 0, 1])
    none = L.LightSelection([away, below, black]).draw([0.0, 0, 0], 0.5, [0.0, 1, 0])
    assert none.light == -1 and none.probability == 0
    nothing = L.LightSelection([]).draw([0.0, 0, 0], 0.5)
    assert nothing.light == -1


def test_a_thousand_lights_at_one_place_and_nan():
    choice = L.LightSelection([L.PointLight((1, 1, 1))] * 1000)
    light, p = choice.draw(np.zeros((100, 3)), np.linspace(0, 1, 100, endpoint=False))
    assert len(set(light.tolist())) > 80 and np.allclose(p, 1e-3, rtol=0.1)
    light, p = choice.draw([[np.nan, 0, 0], [0.0, 0, 0]], 0.5)
    assert light[0] == -1 and np.isnan(p[0]) and light[1] >= 0
    # On the light itself.
    light, p = choice.draw([1.0, 1, 1], 0.5)
    assert light >= 0 and p > 0


def test_bad_choices_are_refused():
    with pytest.raises(ValueError, match="method: expected one of"):
        L.LightSelection([], "best")
    with pytest.raises(ValueError, match="light: index 1 at"):
        L.LightSelection([L.PointLight((0, 0, 0))]).probability([0.0, 0, 0], [1])


@pytest.mark.parametrize("seed", range(20))
def test_wide_spots_have_chances_and_leave_none_out(seed):
    """The falloff of a spot wider than a right angle is no cosine."""
    rng = np.random.default_rng(seed)
    outer = rng.uniform(0.1, np.pi, 6)
    axes = rng.normal(size=(6, 3))
    many = [
        L.SpotLight(p, d, (1, 1, 1), rng.uniform(0, o), o)
        for p, d, o in zip(rng.uniform(-3, 3, (6, 3)), axes, outer, strict=True)
    ]
    many += [L.PointLight((0, 1, 0), (0.1, 0.1, 0.1)), L.PointLight((4, 4, 4))]
    points = rng.uniform(-5, 5, (40, 3))
    chances = L.LightSelection(many).probability(points[:, None], np.arange(8))
    assert (chances >= 0).all() and (chances <= 1).all()
    up = np.array([0.0, 1.0, 0.0])
    for i, light in enumerate(many):
        shines = L.irradiance(light, points, up)[:, 0] + L.irradiance(light, points, -up)[:, 0] > 0
        assert (chances[shines, i] > 0).all()


@pytest.mark.parametrize("dtype", FLOATS)
@pytest.mark.parametrize("method", ["power", "tree"])
def test_faint_lights_beside_a_very_bright_one_are_drawn(method, dtype):
    many = [L.PointLight((0, 0, 0), (1e9,) * 3)] + [L.PointLight((float(i), 0, 0)) for i in range(1, 6)]
    choice = L.LightSelection(many, method)
    point = np.array([3, 0.01, 0], dtype)
    chances = choice.probability(point, np.arange(6))
    assert (chances > 1e-16).all() and chances.sum() == pytest.approx(1, abs=1e-5)
    drawn, _ = choice.draw(point, (np.arange(1 << 18) / (1 << 18)).astype(dtype))
    assert method == "tree" or set(drawn) == set(range(6))


def test_any_collection_of_lights_counts_all_and_numbers_beyond_one_are_nan():
    three = [L.PointLight((float(i), 1, 0)) for i in range(3)]
    assert len(L.LightSelection(x for x in three)) == 3 == len(L.LightSelection(np.array(three, object)))
    light, chance = L.LightSelection(three, "uniform").draw([0.0, 0, 0], [1.5, -1.0, 1.0, 0.5])
    assert (light[:3] == -1).all() and np.isnan(chance[:3]).all() and light[3] == 1
