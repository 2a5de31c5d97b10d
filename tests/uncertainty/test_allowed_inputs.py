"""Inputs move within what their case allows; where no band can be had, a line says why."""

import json

import pytest

from strikewave import load_case, run_case
from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.wave import run as bar_band
from strikewave.analyses.wave.run import run_wave
from strikewave.base.quantities import Range, Value
from strikewave.cases.files import read_case_text
from strikewave.uncertainty.draws import UncertainInput, allowed_inputs, range_of
from strikewave.uncertainty.input_ranges import known_inputs

RUBBER = "iec-60068-2-27-rubber"
LOSSES = {
    "retardation": ["contact.restitution=1", "contact.cushion.retardation=50 us"],
    "loss factor": ["contact.restitution=1", "contact.cushion.loss_factor=0.1", "contact.cushion.loss_frequency=80 Hz"],
    "felt": [
        "machine.follow=30 ms",
        "contact.restitution=1",
        "contact.cushion.stress=8 MPa",
        "contact.cushion.exponent=3",
        "contact.cushion.retardation=50 us",
    ],
}
"""Every way in which a cushion loses energy by rate: its restitution is 1, and nothing else is allowed."""


def lossy(loss, folder):
    """Return the drop table on a pad with a loss of its own."""
    text, _ = read_case_text(RUBBER)
    path = folder / "pad.toml"
    path.write_text(text.replace('material = "natural rubber 65 IRHD"', 'law = "felt"') if loss == "felt" else text)
    return load_case(str(path), LOSSES[loss])


@pytest.mark.verify
@pytest.mark.parametrize("loss", LOSSES)
def test_a_cushion_with_a_loss_of_its_own_has_a_band(loss, tmp_path):
    solution = run_case(lossy(loss, tmp_path), band=True)
    assert solution.band_method.failed == 0
    moved = {one.field for one in solution.band_method.inputs}
    assert "contact.cushion.thickness" in moved
    assert "contact.restitution" not in moved
    band, blow = solution.band["first.rigid_peak"], solution.blows[0]
    assert band.low < blow.rigid_peak < band.high
    assert {"first.width", "first.velocity_change"} <= set(solution.band)


def test_a_side_that_the_case_refuses_is_left_out_and_the_other_kept():
    """The centre of an arm may lie as far out as its inertia allows; a thousandth of the range is the last step."""
    case = load_case("mil-s-901d-hammer")
    value = case.values()["machine.centre"]
    apart = UncertainInput("machine.centre", value, range_of(case, "machine.centre"), 0.9 * value.si, 1.3 * value.si)
    (one,) = allowed_inputs(case, (apart,), build_machine)
    most = (case.machine.inertia.si / case.machine.mass.si) ** 0.5
    assert one.low == apart.low
    assert most - 1e-3 * (apart.high - value.si) <= one.high <= most
    assert one.reason.endswith("as far as the case allows")


@pytest.mark.parametrize("name", ["li-ma-2019", "jesd22-b111-b", "mil-s-901d-hammer", "endevco-tp-321"])
def test_where_nothing_is_refused_every_input_moves_as_far_as_before(name):
    case = load_case(name)
    known = known_inputs(case)
    assert allowed_inputs(case, known, build_machine) == known


def test_an_input_that_may_move_to_no_side_is_left_out(tmp_path):
    case = lossy("felt", tmp_path)
    value = Value(si=1.0, typed=1)
    only = UncertainInput("contact.restitution", value, Range("", 0.0, 1.0), 0.9, 1.0)
    assert allowed_inputs(case, (only,), build_machine) == ()


@pytest.mark.parametrize(
    ("allowed", "ends"),
    [
        ((0.0, 0.275), (0.1, 0.2 + 76 / 1024)),
        ((0.1255, 9.0), (0.2 - 0.1 * 762 / 1024, 1.2)),
        ((0.1995, 1.1), (0.2 - 0.1 * 5 / 1024, 0.2 + 921 / 1024)),
    ],
)
def test_the_end_of_what_is_allowed_is_found_to_a_thousandth_of_a_side(allowed, ends):
    """Ten halvings: of 1024 parts of a side, counted from the value, the last that is allowed."""
    case = load_case("mil-s-901d-hammer")
    value = Value(si=0.2, typed="0.2 m")
    one = UncertainInput("machine.radius", value, range_of(case, "machine.radius"), 0.1, 1.2)
    other = UncertainInput("object.mass", Value(si=3.0, typed="3 kg"), range_of(case, "object.mass"), 2.0, 5.0)

    def build(made):
        if made.object.mass.si != 3.0 and made.machine.radius.si != 0.2:
            raise AssertionError("one input at a time")
        if not allowed[0] <= made.machine.radius.si <= allowed[1]:
            raise ArithmeticError

    found = allowed_inputs(case, (one, other), build)
    assert found[1] == other
    assert (found[0].low, found[0].high) == pytest.approx(ends, rel=1e-12)


def test_of_a_case_that_is_refused_as_it_is_no_input_is_changed():
    case = load_case("mil-s-901d-hammer")
    known = known_inputs(case)[:3]

    def refuse(_):
        raise ValueError

    assert allowed_inputs(case, known, refuse) == known
    assert allowed_inputs(case, (), refuse) == ()


@pytest.mark.usefixtures("undrawn")
def test_a_result_without_a_band_says_why_on_screen_and_in_json_and_report(strikewave, monkeypatch, tmp_path):
    def refuse(*_):
        raise ValueError("the pad is gone")

    monkeypatch.setattr("strikewave.analyses.machine.band.drawn_case", refuse)
    code, out, err = strikewave("run", RUBBER, "--json", "--out", "kept")
    assert code == 0, err
    (notice,) = (one for one in json.loads(out)["warnings"] if one["code"] == "no-band")
    assert "128 could not be made, the first because of the pad is gone" in notice["message"]
    assert "rigid peak" in notice["message"]
    assert "the pad is gone" in (tmp_path / "kept" / "report.html").read_text()
    assert "no-band" in strikewave("run", RUBBER, "--out", "screen")[2]


def test_a_bar_that_takes_too_long_for_a_band_says_so(monkeypatch):
    monkeypatch.setattr(bar_band, "BAND_WORK", 1.0)
    solution = bar_band.with_bands(run_wave(load_case("li-ma-2019-fig13-bar")))
    assert not solution.band
    assert "no-band" in [notice.code for notice in solution.notices]
