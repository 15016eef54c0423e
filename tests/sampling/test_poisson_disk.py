"""Poisson disks: no two points too near, hardly a gap left, all of the domain used, no power at low frequencies."""

import numpy as np
import pytest
import shadelab as sl
from scipy.spatial import cKDTree
from scipy.stats import qmc

CASES = [(domain, d) for domain in ("torus", "square", "disk") for d in (2, 3)]


def distances(domain, points, queries, k):
    tree = cKDTree(points, boxsize=1 if domain == "torus" else None)
    return tree.query(queries, k)[0]


@pytest.mark.parametrize(("domain", "d"), CASES)
def test_points_keep_their_distance_and_leave_no_room(domain, d):
    radius = {2: 0.03, 3: 0.12}[d]
    p = sl.sampling.poisson_disk(radius, d, domain=domain, seed=5)
    assert distances(domain, p, p, 2)[:, 1].min() >= radius
    queries = np.random.default_rng(0).uniform(0, 1, (20000, d))
    if domain == "disk":
        queries = 2 * queries - 1
        queries = queries[np.linalg.norm(queries, axis=1) <= 1]
        assert np.linalg.norm(p, axis=1).max() <= 1
        assert np.linalg.norm(p, axis=1).max() > 1 - 2 * radius
    else:
        assert p.min() >= 0
        assert p.max() < 1
    # Thirty attempts leave little room for another point.
    gaps = distances(domain, p, queries, 1)
    assert (gaps >= radius).mean() < 0.02
    assert gaps.max() < 2 * radius


@pytest.mark.parametrize("radius", [0.4999, 0.35, 0.26, 0.2])
@pytest.mark.parametrize("d", [2, 3])
def test_large_radii_see_all_the_way_around(radius, d):
    for seed in range(20):
        p = sl.sampling.poisson_disk(radius, d, seed=seed)
        gap = np.abs(p[:, None] - p)
        gap = np.linalg.norm(np.minimum(gap, 1 - gap), axis=-1)[np.triu_indices(len(p), 1)]
        assert (gap >= radius).all()
    assert len(sl.sampling.poisson_disk(3, 2, domain="square")) == 1


def test_as_many_points_as_scipys():
    ours = np.mean([len(sl.sampling.poisson_disk(0.07, domain="square", seed=s)) for s in range(3)])
    theirs = np.mean([len(qmc.PoissonDisk(2, radius=0.07, rng=s).fill_space()) for s in range(3)])
    # SciPy throws at one distance alone and leaves more gaps.
    assert 0.98 < ours / theirs < 1.15


def test_low_frequencies_are_silent_and_seeds_differ():
    sets = [sl.sampling.poisson_disk(0.04, seed=s) for s in range(4)]
    n = min(map(len, sets))
    radial = np.mean([sl.sampling.power_spectrum(p, reach=60).radial for p in sets], axis=0)
    # Rings below half of the main frequency; random points have 1.
    assert radial[2 : int(0.4 * np.sqrt(n))].max() < 0.25
    assert not np.array_equal(sets[0][:10], sets[1][:10])
    assert np.array_equal(sets[0], sl.sampling.poisson_disk(0.04, seed=0))
    assert sl.sampling.poisson_disk(0.2, dtype=np.float32).dtype == np.float32


def test_bad_arguments_are_named():
    for radius in (0, -1, np.nan, 0.5, 1e-6):
        with pytest.raises(ValueError, match="radius"):
            sl.sampling.poisson_disk(radius)
    with pytest.raises(ValueError, match="domain"):
        sl.sampling.poisson_disk(0.1, domain="ball")
    with pytest.raises(ValueError, match="dimensions"):
        sl.sampling.poisson_disk(0.1, 4)
