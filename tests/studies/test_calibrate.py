"""The fitted values of the published case come from the fit, and only from the first measured pulse."""

import pytest

from strikewave import load_case
from strikewave.base.errors import InputError
from strikewave.studies.calibrate import calibrate, rounded


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
