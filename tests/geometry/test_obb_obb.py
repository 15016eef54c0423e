"""Oriented boxes: whether convex hulls meet, by linear programming and in rationals; near-parallel edges above all."""

from fractions import Fraction
from itertools import combinations, product

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation
from shadelab import geometry

SIGNS = np.array(list(product((-1, 1), repeat=3)))


def corners(center, axes, half):
    return center + (SIGNS[:, :, None] * half[:, None] * axes).sum(1)


def hulls_meet(p, q):
    """Whether some point is a convex combination of either set."""
    n, m = len(p), len(q)
    equal = np.block([[p.T, -q.T], [np.ones(n), np.zeros(m)], [np.zeros(n), np.ones(m)]])
    return linprog(np.zeros(n + m), A_eq=equal, b_eq=[0, 0, 0, 1, 1]).status == 0


def separated(a, b):
    """By all products of edges, of one box or of both, in rationals."""

    def rational(x):
        return np.vectorize(lambda v: Fraction(float(v)), otypes=[object])(x)

    (ac, aa, ah), (bc, ba, bh) = (tuple(rational(x) for x in box) for box in (a, b))
    edges = [*aa, *ba]
    for u, v in combinations(edges, 2):
        n = np.array([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])
        reach = sum(h * abs(n @ e) for h, e in zip([*ah, *bh], edges, strict=True))
        if abs(n @ (bc - ac)) > reach:
            return True
    return False


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_answers_are_those_of_linear_programming(dtype):
    rng = np.random.default_rng(1)
    n = 150
    # Small grids under rotations by the 3-4-5 triangle: contacts of every kind, none nearer than a thousandth.
    turn = np.array([[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1]])
    some = [np.eye(3), turn, turn.T[[1, 2, 0]][:, [1, 2, 0]], turn @ turn]
    aa, ba = (np.array([some[i] for i in rng.integers(0, 4, n)]) for _ in range(2))
    ac, bc = rng.integers(-2, 3, (2, n, 3)).astype(float)
    ah, bh = rng.integers(0, 4, (2, n, 3)) / 2
    met = [hulls_meet(corners(*a), corners(*b)) for a, b in zip(zip(ac, aa, ah), zip(bc, ba, bh), strict=True)]  # noqa: B905
    got = geometry.obb_obb(*(x.astype(dtype) for x in (ac, aa, ah, bc, ba, bh)), full_output=True)
    # Where they touch, rounded axes make it a matter of rounding.
    firm = np.abs(got.gap) > 1e-5
    assert np.array_equal(got.overlap[firm], np.array(met)[firm]) and firm.sum() > 80
    assert 30 < got.overlap.sum() < 120 and np.array_equal(got.overlap, got.axis == -1)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("tilt", [0.0, 1e-9, 1e-4])
def test_near_parallel_boxes_that_touch_are_told_exactly(dtype, tilt):
    rng = np.random.default_rng(2)
    n = 60
    turns = Rotation.random(n, rng=rng)
    aa = turns.as_matrix().astype(dtype)
    ba = (turns * Rotation.from_rotvec(tilt * rng.normal(size=(n, 3)))).as_matrix().astype(dtype)
    ac = rng.normal(size=(n, 3)).astype(dtype)
    ah, bh = rng.uniform(0.5, 2, (2, n, 3)).astype(dtype)
    # Side by side along an axis of A, touching up to rounding; shifted along the other two.
    shift = rng.uniform(-0.5, 0.5, (n, 3))
    k = rng.integers(0, 3, n)
    shift[np.arange(n), k] = (ah + bh)[np.arange(n), k]
    bc = (ac + np.einsum("ni,nij->nj", shift, aa)).astype(dtype)
    # A tilted box dips into the other; drawn back by that much it touches again, up to rounding.
    near = geometry.obb_obb(ac, aa, ah, bc, ba, bh, full_output=True)
    bc -= near.gap[:, None] * near.direction
    got = geometry.obb_obb(ac, aa, ah, bc, ba, bh, full_output=True)
    boxes = zip(zip(ac, aa, ah), zip(bc, ba, bh), strict=True)  # noqa: B905
    assert got.overlap.tolist() == [not separated(a, b) for a, b in boxes]
    assert np.array_equal(got.overlap, geometry.obb_obb(ac, aa, ah, bc, ba, bh))
    assert 5 < got.overlap.sum() < 55
    # Whatever gap there is, it is of the size of rounding.
    assert np.abs(got.gap).max() < 20 * np.finfo(dtype).eps


def test_the_gap_is_a_distance_that_the_axis_shows():
    rng = np.random.default_rng(3)
    n = 200
    aa, ba = Rotation.random(n, rng=rng).as_matrix(), Rotation.random(n, rng=rng).as_matrix()
    ac, bc = rng.normal(size=(2, n, 3))
    ah, bh = rng.uniform(0.1, 1, (2, n, 3))
    got = geometry.obb_obb(ac, aa, ah, bc, ba, bh, full_output=True)
    a = ac[:, None] + np.einsum("kj,nj,nji->nki", SIGNS, ah, aa)
    b = bc[:, None] + np.einsum("kj,nj,nji->nki", SIGNS, bh, ba)
    gap = np.einsum("nki,ni->nk", b, got.direction).min(1) - np.einsum("nki,ni->nk", a, got.direction).max(1)
    assert np.allclose(gap, got.gap, atol=1e-12) and np.array_equal(got.gap > 0, ~got.overlap)
    assert 20 < got.overlap.sum() < 180
    # Moving B by the gap along the axis makes boxes that overlap touch, so that a little more parts them.
    into = got.overlap
    away = bc - (got.gap - 1e-9)[:, None] * got.direction
    assert not geometry.obb_obb(ac, aa, ah, away, ba, bh)[into].any()


def test_symmetric_and_blind_to_shifts_that_are_exact():
    rng = np.random.default_rng(4)
    aa, ba = (np.round(Rotation.random(100, rng=rng).as_matrix(), 3) for _ in range(2))
    ac, bc = rng.integers(-16, 17, (2, 100, 3)) / 8
    ah, bh = rng.integers(0, 9, (2, 100, 3)) / 8
    one = geometry.obb_obb(ac, aa, ah, bc, ba, bh)
    assert np.array_equal(one, geometry.obb_obb(bc, ba, bh, ac, aa, ah))
    assert np.array_equal(one, geometry.obb_obb(ac + 2**20, aa, ah, bc + 2**20, ba, bh))


def test_nan_and_negative_extents_meet_nothing_and_touch_no_other():
    half = [[1, 1, 1], [1, -1, 1], [1, np.nan, 1]]
    got = geometry.obb_obb([0, 0, 0.0], np.eye(3), half, [1, 0, 0], np.eye(3), [1, 1, 1], full_output=True)
    assert got.overlap.tolist() == [True, False, False] and np.isnan(got.gap[1:]).all()
