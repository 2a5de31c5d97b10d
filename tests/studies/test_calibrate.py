"""The fitted values of the published case come from the fit, and only from the first measured pulse."""

import pytest

from strikewave import load_case
from strikewave.base.errors import InputError
from strikewave.base.quantities import Value
from strikewave.cases.case import dump_case, parse_case
from strikewave.studies.calibrate import calibrate, rounded, with_fit_recorded


def test_stored_values_are_those_of_the_fit():
    """From 10 and 20 % beside them, the search returns to the values in the file (seven digits are stored)."""
    stored = load_case("li-ma-2019")
    moved = {}
    for path, share in (("machine.engagement", 1.1), ("object.frame_stiffness", 0.8)):
        value = stored.values()[path]
        moved[path] = value.model_copy(update={"si": value.si * share, "typed": rounded(value.typed, share)})
    fit = calibrate(stored.with_values(moved))
    for path in moved:
        assert fit.case.values()[path].si == pytest.approx(stored.values()[path].si, rel=2e-6)
    assert max(abs(miss) for miss in fit.misses.values()) < 1e-6


def test_only_the_first_measured_pulse_is_fitted():
    fitted = [(p.quantity, p.origin, p.value.typed) for p in load_case("li-ma-2019").published if p.role == "fitted"]
    assert fitted == [("first.rigid_peak", "measured", "4151.25 g"), ("first.width", "measured", "200 us")]


def test_fit_without_fitted_values_is_refused():
    case = load_case("li-ma-2019", ["machine.engagement=5 mm", "object.frame_stiffness=90 MN/m"])
    with pytest.raises(InputError, match="at least as many targets"):
        calibrate(case)


def test_engagement_of_the_two_sensor_case_is_found_again():
    """From 10 % off, fitted to the buffered sensor's first peak alone; the directly mounted one is no target."""
    case = load_case("li-ma-2019-fig5")
    fitted = case.values()["machine.engagement"]
    off = case.with_values({"machine.engagement": fitted.model_copy(update={"si": 1.1 * fitted.si})})
    fit = calibrate(off)
    assert fit.case.values()["machine.engagement"].si == pytest.approx(fitted.si, rel=1e-5)  # a peak is read at samples
    assert set(fit.misses) == {"first.sensor_peak buffered"}


def test_a_fit_is_recorded_under_what_the_case_has_now():
    """Fitted anew under another speed: the record follows it, and a later change is noticed again."""
    case = load_case("li-ma-2019", ["machine.speed=700 rpm"])
    assert case.stale_fits()
    fitted = calibrate(case).case
    assert fitted.fit[0].under["machine.speed"] == "700 rpm"
    assert fitted.fit[0].under["machine.engagement"] == fitted.machine.engagement.typed
    assert fitted.fit[0].under["stack.layer"] == "none"
    again = parse_case(dump_case(fitted))
    assert again.fitted_fields() == fitted.fitted_fields()  # not taken for the user's own numbers
    assert not again.stale_fits()
    changed = again.with_values({"striker.mass": Value(si=1.2, typed="1.2 kg")})
    assert [field.path for field in changed.stale_fits()[0].changed] == ["striker.mass"]


def test_a_fit_without_a_record_gets_one_of_every_field_that_a_blow_feels():
    case = load_case("li-ma-2019").model_copy(update={"fit": ()})
    recorded = with_fit_recorded(case, case.fitted_fields(), ["first.rigid_peak"])
    (fit,) = parse_case(dump_case(recorded)).fit
    assert fit.fields == tuple(case.fitted_fields())
    assert "first rigid peak" in fit.to
    assert {"machine.speed", "object.gravity", "contact.law"} < set(fit.under)
    assert not any(path.startswith(("recorder", "solver", "sensor")) for path in fit.under)
    assert not recorded.stale_fits()
