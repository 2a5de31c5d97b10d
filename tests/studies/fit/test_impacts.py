"""Impacts of two free bodies fitted to stated numbers and to a force pulse, both in closed form; and elements."""

from pathlib import Path

import numpy as np
import pytest

from strikewave import load_case, run_fem
from strikewave.base.errors import InputError
from strikewave.cases.case import parse_case
from strikewave.contact import Contact, exact, impact_history, solve_impact
from strikewave.contact.identification import identify
from strikewave.studies.fit.study import fit

DOCS = Path(__file__).parents[3] / "docs" / "fit.md"
BLOCKS = [text.partition("```")[0] for text in DOCS.read_text("utf-8").split("```toml\n")[1:]]
IMPACT = next(text for text in BLOCKS if "gas-gun" in text)
"""A case of the docs."""
TRUTH = {"contact.reference_force": 15e3, "contact.restitution": 0.6}


def closed_form():
    """Return the impact of the true values, F = K d^1.5 with 15 kN at 100 um, e = 0.6."""
    return solve_impact(Contact(15e3 / 1e-4**1.5, 1.5, exact(0.6)), 0.2, 0.459, 2.0)


def test_peak_force_contact_time_and_restitution_of_an_impact_are_fitted():
    """Stated numbers of the closed form: the values within 5e-3, which the stiff frame leaves of 1e-3 in the numbers."""
    impact = closed_form()
    to = [
        f"first.peak_force={float(impact.peak_force)!r} N +- 1 %",
        f"first.contact_time={float(impact.duration)!r} s +- 1 %",
        f"first.restitution={float(impact.restitution)!r} +- 1 %",
    ]
    study = fit(parse_case(IMPACT), to, list(TRUTH))
    for one in study.parameters:
        assert one.value == pytest.approx(TRUTH[one.field.path], rel=5e-3)
    assert not study.undetermined
    assert max(one.size for one in study.solved.misfits) < 0.2  # standard uncertainties, of 1 % each


def test_a_whole_force_pulse_of_an_impact_is_fitted_as_it_is_identified(tmp_path):
    """The pulse in closed form with 1 % of noise, sampled at 1 MHz: both values within 4 standard errors.

    `identify` is the same fit in closed form: same values within one standard error, which is what the frame of the
    case and the baseline, fitted there and read off the quiet here, leave between them; errors as large within a half,
    since there noise is taken for white.
    """
    history, time = impact_history(closed_form()), np.arange(700) * 1e-6
    force = np.interp(time - 300.3e-6, history.time, history.force, left=0.0, right=0.0)
    force += 0.01 * force.max() * np.random.default_rng(5).standard_normal(time.size)
    path = tmp_path / "force.csv"
    np.savetxt(path, np.column_stack([time, force]), delimiter=",", header="time (s),force (N)", comments="")
    study = fit(parse_case(IMPACT), [str(path)], list(TRUTH))
    for one in study.parameters:
        assert abs(one.value - TRUTH[one.field.path]) < 4.0 * one.standard_error < 0.03 * one.value
    assert not any(one.more_than_noise for one in study.solved.misfits)
    own = identify(time, force, {"mass": 0.2 * 0.459 / 0.659, "speed": 2.0, "exponent": 1.5}).values
    for one, name, unit in zip(study.parameters, ("stiffness", "restitution"), (1e-4**1.5, 1.0), strict=True):
        assert abs(one.value / unit - own[name].value) < own[name].standard_error
        assert one.standard_error / unit == pytest.approx(own[name].standard_error, rel=0.5)


COARSE = ["mesh.part.striker.size=3 mm", "mesh.part.bar.size=3 mm"]


@pytest.mark.verify
def test_a_planted_speed_of_elements_is_found_in_few_runs():
    """Peak force of a coarse run: linear in the speed but for the quadratic viscosity; one search, from the case."""
    peak = run_fem(load_case("two-bars-fem", COARSE)).number("first.peak_force")
    speed = "mesh.part.striker.velocity.z"
    study = fit(load_case("two-bars-fem", [*COARSE, f"{speed}=1.6 m/s"]), [f"first.peak_force={peak!r} N"], [speed])
    assert study.parameters[0].value == pytest.approx(2.0, rel=1e-5)
    assert study.solved.runs < 30


@pytest.mark.parametrize(
    ("free", "to", "words"),
    [
        ("mesh.part.bar.length", "first.peak_force=1 kN", "a quantity of what was tested"),
        ("mesh.part.striker.velocity.z", "first.width=20 us", '"first.width PART" with the name of a part'),
        ("mesh.part.striker.velocity.z", "first.width bra=20 us", 'did you mean "bar"?'),
        ("mesh.part.striker.velocity.z", "first.restitution=0.5", "a number that the case gives"),
    ],
)
def test_what_elements_do_not_give_is_answered_in_one_line(free, to, words):
    with pytest.raises(InputError) as error:
        fit(load_case("two-bars-fem"), [to], [free])
    assert words in str(error.value)
