"""Nodes along a line against geometric progressions in closed form, and for any sizes."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.errors import InputError
from strikewave.fem.sections import Grading, nodes_between, nodes_through

size = st.floats(1e-5, 1e-2)


@st.composite
def gradings(draw):
    coarse = draw(size)
    fine = coarse * draw(st.floats(1e-2, 1.0))
    places = tuple(draw(st.lists(st.floats(-0.01, 0.06), min_size=1, max_size=3)))
    extent = min(draw(st.floats(0.0, 0.01)), 2000.0 * fine)  # three zones then stay below 20 000 elements
    return Grading(coarse, fine, places, extent, draw(st.floats(1.02, 2.0)))


lengths = st.floats(1e-4, 0.05)


@pytest.mark.parametrize(("count", "growth"), [(3, 2.0), (10, 1.2), (25, 1.05)])
def test_a_line_of_the_length_of_a_geometric_series_is_that_series(count, growth):
    sizes = 1e-4 * growth ** np.arange(count)
    nodes = nodes_between(0.0, sizes.sum(), Grading(1.0, fine=1e-4, growth=growth))
    # the count of elements carries a few roundings of ln(growth)
    np.testing.assert_allclose(np.diff(nodes), sizes, rtol=1e-11)


def test_a_line_without_a_fine_zone_is_divided_evenly():
    np.testing.assert_allclose(np.diff(nodes_between(1.0, 2.0, 0.3)), 0.25, rtol=1e-14)


@given(lengths, gradings())
def test_both_ends_are_exact_and_nodes_ascend(length, grading):
    nodes = nodes_between(0.0, length, grading)
    assert nodes[0] == 0.0
    assert nodes[-1] == length
    assert np.all(np.diff(nodes) > 0.0)


@given(lengths, gradings())
def test_neighbours_never_differ_by_more_than_the_growth(length, grading):
    step = np.diff(nodes_between(0.0, length, grading))
    # nodes are rounded to 2^-53 of the length, and a ratio of sizes feels it by length over size
    slack = 1.0 + 1e-9 + 8.0 * np.finfo(float).eps * length / step.min()
    assert np.all(step[1:] / step[:-1] <= grading.growth * slack)
    assert np.all(step[:-1] / step[1:] <= grading.growth * slack)


@given(lengths, gradings())
def test_no_element_is_larger_than_asked_for_at_its_larger_end(length, grading):
    nodes = nodes_between(0.0, length, grading)
    asked = np.maximum(grading.size(nodes[1:]), grading.size(nodes[:-1]))
    kinks = grading.size(0.5 * (nodes[1:] + nodes[:-1]))
    assert np.all(np.diff(nodes) <= np.maximum(asked, kinks) * (1.0 + 1e-9) + 1e-15)


@given(st.floats(1e-5, 1e-3), st.floats(1.05, 1.5), st.integers(10, 40))
def test_the_first_element_is_the_finest_to_one_part_in_the_count(fine, growth, count):
    length = fine * (growth**count - 1.0) / (growth - 1.0) * 1.03
    step = np.diff(nodes_between(0.0, length, Grading(1.0, fine=fine, growth=growth)))
    assert step[0] == step.min()
    # count elements at most are squeezed by one: ratios shrink from growth to growth^(n / (n + 1))
    assert fine * (1.0 - 1.0 / len(step)) * 0.9 <= step[0] <= fine * (1.0 + 1e-9)


@given(gradings(), st.lists(st.floats(1e-3, 0.05), min_size=2, max_size=5, unique=True))
def test_a_line_has_a_node_at_each_of_its_breaks(grading, breaks):
    breaks = sorted(breaks)
    if min(np.diff(breaks)) < 1e-6:
        breaks = [0.0, 0.01, 0.02]
    assert np.isin(breaks, nodes_through(breaks, grading)).all()


def test_a_grading_is_symmetric_about_its_place():
    nodes = nodes_between(0.0, 0.06, Grading(2e-3, 5e-4, at=(0.03,), extent=2e-3))
    np.testing.assert_allclose(nodes + nodes[::-1], 0.06, rtol=1e-13)


@pytest.mark.parametrize(
    ("field", "make"),
    [
        ("grading.coarse", lambda: Grading(0.0)),
        ("grading.coarse", lambda: Grading(math.nan)),
        ("grading.fine", lambda: Grading(1e-3, fine=2e-3)),
        ("grading.growth", lambda: Grading(1e-3, growth=1.0)),
        ("grading.extent", lambda: Grading(1e-3, extent=-1.0)),
        ("grading.coarse", lambda: Grading(math.inf)),
        ("grading.fine", lambda: Grading(1e-3, fine=0.0)),
        ("grading.growth", lambda: Grading(1e-3, growth=2.02)),
        ("grading.extent", lambda: Grading(1e-3, extent=math.inf)),
        ("grading.extent", lambda: Grading(1e-3, extent=-0.005)),
        ("grading.at", lambda: Grading(1e-3, at=())),
        ("grading.at", lambda: Grading(1e-3, at=(0.0, math.nan))),
        ("size", lambda: nodes_between(0.0, 20_001.0, 1.0)),
        ("length", lambda: nodes_between(1.0, 1.0, 0.1)),
        ("size", lambda: nodes_between(0.0, 1.0, 1e-9)),
    ],
)
def test_a_grading_that_cannot_be_is_refused_by_name(field, make):
    with pytest.raises(InputError) as error:
        make()
    assert error.value.field == field


def test_gradings_at_the_ends_of_their_ranges_are_taken():
    assert Grading(1e-3, fine=1e-3, growth=2.0).finest == 1e-3
    assert Grading(1e-3).finest == 1e-3
    assert Grading(1e-3, growth=1.5).slope == pytest.approx(0.405465108108, rel=1e-11)
    assert len(nodes_between(0.0, 19_999.0, 1.0)) == 20_000


@pytest.mark.parametrize(("more", "count"), [(0.6e-9, 4), (1.5e-9, 5)])
def test_a_count_within_a_billionth_of_a_whole_number_is_that_number(more, count):
    assert len(nodes_between(0.0, 4.0 + more, 1.0)) == count + 1


def test_sizes_by_hand():
    """Twice a metre farther: ln 2 a metre. Fine zones of 2 m about 1 and 9 m; without extent one begins below fine."""
    twice = Grading(3.0, fine=0.5, at=(1.0, 9.0), extent=2.0, growth=2.0)
    rise = math.log(2.0)
    expected = [0.5, 0.5, 0.5 + rise, 0.5 + 2.0 * rise, 0.5 + 0.5 * rise, 0.5, 3.0]
    np.testing.assert_allclose(twice.size(np.array([-1.0, 2.5, 4.0, 5.0, 6.5, 11.0, 20.0])), expected, rtol=1e-14)
    point = Grading(3.0, fine=0.5, growth=1.5)
    expected = [0.5 * math.log(1.5) / 0.5, 0.5 * math.log(1.5) / 0.5 + 2.0 * math.log(1.5)]
    np.testing.assert_allclose(point.size(np.array([0.0, 2.0])), expected, rtol=1e-14)
    assert Grading(3.0, extent=1.0).size(np.array([0.0, 9.0])).tolist() == [3.0, 3.0]


def test_nodes_of_a_line_stand_at_equal_shares_of_the_integral_of_one_over_the_size():
    """By quadrature in many steps, of two fine zones between the ends."""
    grading = Grading(2.0, fine=0.3, at=(3.0, 11.0), extent=0.7, growth=1.4)
    nodes = nodes_between(-1.0, 16.0, grading)
    x = np.linspace(-1.0, 16.0, 200_001)
    density = 1.0 / grading.size(x)
    reached = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(x))])
    # the trapezoidal rule errs by the kinks, 1e-8 of a step there
    np.testing.assert_allclose(np.interp(nodes, x, reached), np.linspace(0.0, reached[-1], len(nodes)), atol=1e-6)
    assert len(nodes) - 1 == math.ceil(reached[-1])
