"""Pictures of contacts: what they draw is what is computed."""

import math

import numpy as np
import pytest

from strikewave.analyses.impact.figures import asked_given, stiffness_over_load
from strikewave.analyses.impact.report import impact_sheet
from strikewave.base.constants import material
from strikewave.contact import (
    Contact,
    Geometry,
    damping_laws,
    exact,
    impact_history,
    line_cap,
    restitution,
    solve_impact,
    stiffness_laws,
    stiffness_of,
)

STEEL = material("65Mn")
SIZES = Geometry(0.010, 0.020, 0.040)
LOADS = np.geomspace(100.0, 1e5, 31)


@pytest.fixture(scope="module")
def blows():
    """Three blows on one spot that yields."""
    cap = line_cap(STEEL, STEEL, 0.010, 0.020, 0.040, 1.2e9)
    contact = stiffness_of("johnson", STEEL, STEEL, SIZES).contact(exact(0.7), cap)
    found, deepest = [], 0.0
    for _ in range(3):
        found.append(solve_impact(contact, 0.2, 0.459, 5.0, deepest))
        deepest = found[-1].deepest
    return found


def curves(axes):
    return [line for line in axes.lines if len(line.get_xdata()) > 2]


def marks(axes):
    return [line for line in axes.lines if len(line.get_xdata()) == 1]


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_loops_stand_where_they_begin(blows):
    figure = impact_sheet(blows, ["a", "b", "c"], "three blows")
    _, axes, _ = figure.axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("indentation (µm)", "force (kN)")
    assert legend(figure) == ["a", "b", "c", "largest force"]
    assert len(curves(axes)) == 3
    before = 0.0
    for line, mark, blow in zip(curves(axes), marks(axes), blows, strict=True):
        d, f = line.get_xdata(), line.get_ydata()
        assert d[0] == pytest.approx(before, abs=1e-9)
        assert d.max() == pytest.approx(float(blow.max_indentation) * 1e6, rel=1e-6)
        assert f.max() == pytest.approx(float(blow.peak_force) / 1e3, rel=1e-6)
        assert mark.get_ydata()[0] == pytest.approx(float(blow.peak_force) / 1e3, rel=1e-6)
        before = float(blow.residual_indentation) * 1e6
        assert d[-1] == pytest.approx(before, rel=1e-4)


def test_phase_plane_in_shares(blows):
    _, _, axes = impact_sheet(blows, ["a", "b", "c"], "three blows").axes
    assert axes.get_xlabel() == "indentation / largest indentation (-)"
    assert axes.get_ylabel() == "rate / approach speed (-)"
    for line, blow in zip(curves(axes), blows, strict=True):
        assert line.get_xdata().max() == pytest.approx(1.0, rel=1e-6)
        assert line.get_ydata()[0] == pytest.approx(1.0, rel=1e-12)
        assert line.get_ydata()[-1] == pytest.approx(-float(blow.restitution), rel=1e-5)


def test_sheet_of_one_blow():
    blow = solve_impact(Contact(4.7e9, 10 / 9, exact(0.5)), 0.2, 0.459, 5.0)
    figure = impact_sheet([blow], ["blow 1"], "palmgren, damping exact")
    assert figure.get_suptitle() == "palmgren, damping exact"
    labels = [(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes]
    assert labels == [
        ("time after first touch (µs)", "force (kN)"),
        ("indentation (µm)", "force (kN)"),
        ("indentation / largest indentation (-)", "rate / approach speed (-)"),
    ]
    (line,) = curves(figure.axes[0])
    history = impact_history(blow, line.get_xdata() / 1e6)
    np.testing.assert_allclose(line.get_ydata(), history.force / 1e3, rtol=1e-9, atol=1e-9)
    (mark,) = marks(figure.axes[0])
    place = float(mark.get_xdata()[0]), float(mark.get_ydata()[0])
    assert place == pytest.approx((float(blow.peak_time) * 1e6, float(blow.peak_force) / 1e3), rel=1e-9)


def test_asked_given_of_every_law():
    figure = asked_given()
    above, below = figure.axes
    assert above.get_ylabel() == "restitution given (-)"
    assert (below.get_xlabel(), below.get_ylabel()) == ("restitution asked for, e (-)", "difference (% of e)")
    laws = damping_laws()
    drawn = {line.get_label().removesuffix(" (from memory)"): line for line in above.lines}
    assert set(drawn) == {*laws, "given = asked"}
    for name, law in laws.items():
        e = drawn[name].get_xdata()
        assert (e[0], e[-1]) == (0.01, 1.0)
        np.testing.assert_array_equal(drawn[name].get_ydata(), restitution(law.function(e)))
        assert (drawn[name].get_linestyle() == "--") == (law.status == "from memory")
    middle = [float(np.interp(0.5, line.get_xdata(), line.get_ydata())) for line in above.lines[1:]]
    assert middle == sorted(middle, reverse=True)
    assert [name.removesuffix(" (from memory)") for name in legend(figure)] == list(drawn)
    for line, other in zip(above.lines[1:], curves(below), strict=True):
        e, given = line.get_xdata(), line.get_ydata()
        np.testing.assert_allclose(other.get_ydata(), 100.0 * (given - e) / e, atol=1e-9)
        low, high = below.get_ylim()
        assert low < other.get_ydata().min()
        assert other.get_ydata().max() < high


def test_lines_differ_in_more_than_colour():
    looks = {(line.get_color(), line.get_marker()) for line in asked_given().axes[0].lines[1:]}
    assert len(looks) == len(damping_laws())


def test_stiffness_over_load():
    figure = stiffness_over_load(STEEL, STEEL, SIZES, LOADS)
    above, below = figure.axes
    assert above.get_ylabel() == "indentation (µm)"
    assert (below.get_xlabel(), below.get_ylabel()) == ("load (kN)", "difference from johnson (%)")
    assert (above.get_xscale(), above.get_yscale()) == ("log", "log")
    assert "R1 10 mm, R2 20 mm, length 40 mm" in above.get_title(loc="left")
    drawn = {line.get_label(): line for line in above.lines}
    assert set(drawn) == set(stiffness_laws())
    johnson = stiffness_of("johnson", STEEL, STEEL, SIZES)
    np.testing.assert_allclose(drawn["johnson"].get_ydata(), johnson.indentation(LOADS) * 1e6, rtol=1e-12)
    palmgren = stiffness_of("palmgren", STEEL, STEEL, SIZES)
    depth = drawn["palmgren"].get_ydata() / 1e6
    np.testing.assert_allclose(palmgren.stiffness * depth**palmgren.exponent, LOADS, rtol=1e-12)
    share = dict(zip(drawn, below.lines, strict=True))["palmgren"].get_ydata()
    np.testing.assert_allclose(share, 100.0 * (depth / johnson.indentation(LOADS) - 1.0), rtol=1e-9)


def test_laws_without_their_sizes_are_left_out():
    figure = stiffness_over_load(STEEL, STEEL, Geometry(length=0.040), LOADS)
    assert [line.get_label() for line in figure.axes[0].lines] == ["palmgren"]
    assert figure.axes[1].get_ylabel() == "difference from palmgren (%)"
    plane = stiffness_over_load(STEEL, STEEL, Geometry(0.010, math.inf, 0.040), LOADS)
    assert {line.get_label() for line in plane.axes[0].lines} == {"hertz", "palmgren", "pereira", "lankarani-nikravesh"}
    with pytest.raises(ValueError, match="no stiffness law"):
        stiffness_over_load(STEEL, STEEL, Geometry(), LOADS)


def test_a_logarithmic_law_is_drawn_to_its_end():
    law = stiffness_of("johnson", STEEL, STEEL, SIZES)
    end = law.load / math.e
    figure = stiffness_over_load(STEEL, STEEL, SIZES, [0.5 * end, 0.999 * end, 1.001 * end])
    line = next(line for line in figure.axes[0].lines if line.get_label() == "johnson")
    np.testing.assert_array_equal(np.isnan(line.get_ydata()), [False, False, True])
