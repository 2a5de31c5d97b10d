"""What is free and what it is fitted to, as typed: bounds, scales, numbers with their uncertainties, records, settings."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave import load_case
from strikewave.base.errors import InputError
from strikewave.base.quantities import Range, Value
from strikewave.cases.plausible import PLAUSIBLE
from strikewave.studies.fit import free_fields as free_fields_module
from strikewave.studies.fit import targets as targets_module
from strikewave.studies.fit.checking import read_tries
from strikewave.studies.fit.free_fields import FreeField, _stair, case_at, free_fields, smooth_case, stairs
from strikewave.studies.fit.measured import MeasuredNumber
from strikewave.studies.fit.targets import (
    Target,
    _blows,
    _part,
    parse_target,
    parse_targets,
    published_targets,
    read_number,
    read_targets,
    target_words,
)

DROP, PAPER, BAR = load_case("jesd22-b111-b"), load_case("li-ma-2019"), load_case("li-ma-2019-fig13-bar")


def test_places_values_and_errors_go_with_logarithms_or_differences():
    """From 2 to 32 a quarter is 4 on a logarithm, whose error is a share; from -6 to 4 it is -3.5, and 10 times as wide."""
    value = Value(si=4.0, typed=4.0)
    scale, width = (FreeField("x", value, Range(""), *ends) for ends in ((2.0, 32.0, True), (-6.0, 4.0, False)))
    assert (scale.width, width.width) == (pytest.approx(math.log(16.0)), 10.0)
    assert (scale.si(0.25), width.si(0.25)) == (pytest.approx(4.0), pytest.approx(-3.5))
    assert (scale.place(4.0), width.place(-3.5)) == (pytest.approx(0.25), pytest.approx(0.25))
    assert scale.error(-5.0, 0.03) == pytest.approx(0.03 * math.log(16.0) * 5.0)
    assert width.error(-5.0, 0.03) == pytest.approx(0.3)
    assert [scale.si(at) for at in (-0.1, 1.1)] == [2.0, 32.0]
    assert [width.si(at) for at in (-0.1, 1.1)] == [-6.0, 4.0]


@pytest.mark.parametrize(
    ("case", "word", "low", "high", "log"),
    [
        (DROP, "machine.height", 0.027949, 2.7949, True),  # a factor of ten to either side
        (DROP, "contact.exponent", 1.0, 10.0, True),  # none is below 1
        (PAPER, "object.gravity", 0.98, 98.0, True),
        (PAPER, "feed.arrival", 0.0, 1.0, False),  # a share
        (PAPER, "contact.friction", 0.0, 10.0, False),
        (PAPER, "striker.reach_error", -5.0, 5.0, False),  # in widths of what is plausible
        (PAPER, "striker.angle_error", -5.0, 5.0, False),
        (DROP, "striker.mass=1 t..3 t", 1e3, 3e3, True),
        (PAPER, "object.gravity=-5 m/s2..15 m/s2", -5.0, 15.0, False),
        (PAPER, "object.frame_damping=0 N s/m..300 N s/m", 0.0, 300.0, False),
        (PAPER, "object.frame_damping=0.005 N s/m..300 N s/m", 0.005, 300.0, True),
    ],
)
def test_bounds_are_a_decade_to_either_side_all_of_a_share_or_five_widths(case, word, low, high, log):
    (field,) = free_fields(case, [word])
    size = PLAUSIBLE[field.path].size if field.path.endswith("_error") else 1.0
    assert (field.low / size, field.high / size) == pytest.approx((low, high), rel=1e-12)
    assert field.log == log


def test_a_field_at_zero_has_no_decade_to_either_side():
    with pytest.raises(InputError, match="a field whose bounds are known"):
        free_fields(load_case("jesd22-b111-b", ["object.frame_damping=0 N s/m"]), ["object.frame_damping"])
    small = free_fields(load_case("jesd22-b111-b", ["object.frame_damping=0.005 N s/m"]), ["object.frame_damping"])
    assert (small[0].low, small[0].high) == pytest.approx((0.0005, 0.05))


def test_twelve_fields_are_free_at_most():
    paths = [path for path in PAPER.values() if path.partition(".")[0] in ("striker", "object")]
    paths = [path for path in paths if PAPER.values()[path].si > 0.0][:13]
    assert len(free_fields(PAPER, paths[:12])) == 12
    with pytest.raises(InputError, match="13 fields"):
        free_fields(PAPER, paths)
    with pytest.raises(InputError, match="this one is counted"):
        free_fields(PAPER, ["machine.strikers"])


def test_a_case_at_a_place_has_its_fields_there():
    fields = free_fields(DROP, ["machine.height=0.2 m..0.4 m", "striker.mass=1 t..4 t"])
    values = case_at(DROP, fields, np.array([0.5, 0.25])).values()
    assert values["machine.height"].si == pytest.approx(math.sqrt(0.08))
    assert values["striker.mass"].si == pytest.approx(1e3 * 4.0**0.25)
    assert values["object.mass"] == DROP.values()["object.mass"]


@pytest.mark.parametrize(
    ("typed", "value", "uncertainty"),
    [
        ("413 us", 413e-6, 0.01 * 413e-6),  # 1 % at least
        ("413 us +- 3 us", 413e-6, 3e-6),
        ("413 us ± 0.5 %", 413e-6, 0.005 * 413e-6),
        ("17 us", 17e-6, 0.5e-6),  # half its last digit
        ("2 us", 2e-6, 0.2e-6),  # a tenth at most
        ("30 ms+/-2 ms", 30e-3, 2e-3),
    ],
)
def test_a_number_is_as_sure_as_stated_or_as_its_last_digit(typed, value, uncertainty):
    found = read_number(DROP, Target("first.width", typed, ("a=1", "b=2"), is_number=True))
    assert (found.name, found.sensor, found.unit, found.of_field) == ("first.width", "", "s", False)
    assert (found.value, found.uncertainty) == (pytest.approx(value), pytest.approx(uncertainty))
    assert (found.typed, found.setting, found.left) == (
        typed.partition("+")[0].partition("±")[0].strip(),
        "a=1, b=2",
        1.0,
    )


def test_numbers_of_fields_may_be_small_and_of_either_sign():
    known = read_number(DROP, Target("machine.height", "5 mm", is_number=True))
    assert (known.of_field, known.value, known.uncertainty) == (True, 0.005, pytest.approx(0.0005))
    turned = read_number(DROP, Target("first.rigid_peak", "-1500 g +- 30 g", is_number=True))
    assert (turned.value, turned.uncertainty) == pytest.approx((-1500.0 * 9.80665, 30.0 * 9.80665))
    assert read_number(DROP, Target("first.width", "0.005 s +- 1e-9 s", is_number=True)).uncertainty == 1e-9
    assert read_number(DROP, Target("first.rigid_peak", "0.005 m/s2", is_number=True)).value == 0.005


def test_words_are_numbers_of_the_run_or_of_a_field_and_records_else(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("a.csv", "7.csv", "b=c.csv", "b; d=1.csv", "e +- 2 %.csv"):
        (tmp_path / name).write_text("")
    settings = ("machine.height=1 m", "striker.mass = 3 kg")
    for word, target in (
        ("first.width=1 ms", Target("first.width", "1 ms", is_number=True)),
        ("first.sensor_peak top = 3 g", Target("first.sensor_peak top", "3 g", is_number=True)),
        ("machine.height=1 m +- 1 %", Target("machine.height", "1 m +- 1 %", is_number=True)),
        ("a.csv", Target("", "a.csv")),
        ("a.csv ± 3 %; machine.height=1 m; striker.mass = 3 kg", Target("", "a.csv", settings, scatter=0.03)),
        ("board@2=a.csv#1", Target("board@2", "a.csv#1")),
        ("board=none.csv", Target("board", "none.csv")),
        ("board=7.csv", Target("board", "7.csv")),
        ("board=5.csv +- 2 %", None),  # no file: a number of no such name
        ("board=a.csv +- 2 %", Target("board", "a.csv", scatter=0.02)),
        ("b=c.csv", Target("", "b=c.csv")),
        ("b=c.csv#1", Target("", "b=c.csv#1")),
        ("b; d=1.csv", Target("", "b; d=1.csv")),
        ("e +- 2 %.csv", Target("", "e +- 2 %.csv")),
    ):
        if target is None:
            with pytest.raises(InputError, match="board"):
                parse_target(word, DROP)
            continue
        case = DROP if "sensor" not in word else load_case("li-ma-2019-fig5")
        assert parse_target(word, case) == target


def test_targets_of_a_list_stand_in_its_place(tmp_path):
    (tmp_path / "list.txt").write_text("# some\n\n  first.width=1 ms \nfirst.width=2 ms\n #x\n")
    words = ["first.width=0 ms", f"@{tmp_path / 'list.txt'}", "first.width=3 ms"]
    assert target_words(words) == [f"first.width={k} ms" for k in range(4)]
    ready = Target("x", "y")
    assert [one.right for one in parse_targets([ready, *words], DROP)] == ["y", "0 ms", "1 ms", "2 ms", "3 ms"]
    (tmp_path / "long.txt").write_text("a" * 1_000_001)
    assert len(target_words([f"@{tmp_path / 'long.txt'}"])[0]) == 1_000_000


def test_published_numbers_that_were_fitted_are_targets():
    found = published_targets(PAPER)
    wanted = [one for one in PAPER.published if one.role == "fitted"]
    assert 0 < len(found) == len(wanted) < len(PAPER.published)
    assert [(one.left, one.right) for one in found] == [(one.quantity, str(one.value.typed)) for one in wanted]
    assert all(one.is_number for one in found)
    (sensor,) = published_targets(load_case("li-ma-2019-fig5"))
    assert sensor.left == "first.sensor_peak buffered"


def test_a_run_lasts_until_the_last_blow_that_is_asked_for():
    """Of the first numbers one, of the records as far as they say; all of them where any other number is asked for."""

    def one(name, **more):
        return MeasuredNumber(name, "", "", 1.0, 0.1, "", **more)

    first, other, field = one("first.width"), one("mean.width"), one("machine.height", of_field=True)
    assert _blows([], []) == 1
    assert _blows([first, field], [0]) == 1
    assert _blows([first], [4, 2]) == 4
    assert _blows([other, first, field], [4]) == 0
    assert [_part(word) for word in ("board", "board@12", "a@b@3", "board@0")] == [
        ("board", 0),
        ("board", 12),
        ("a@b", 3),
        ("board@0", 0),
    ]


@pytest.mark.parametrize(
    ("steps", "stated", "field", "share"),
    [
        (80, True, "length", 1.0 / 80.0),
        (80, True, "modulus", 2.0 / 80.0),
        (80, False, "length", 6e-4),
        (0, True, "length", 0.0),
        (80, False, "density", 1.2e-3),
    ],
)
def test_a_field_of_a_layer_is_felt_in_steps_of_its_transit(steps, stated, field, share):
    """One of 80 time steps, or twice what the chosen step misses; a transit goes with the root of modulus and density."""
    layers = [SimpleNamespace(name="other", steps=7), SimpleNamespace(name="rod", steps=steps)]
    waves = SimpleNamespace(layers=layers, mismatch=3e-4)
    case = SimpleNamespace(solver=SimpleNamespace(step=1e-7 if stated else None))
    assert _stair(case, waves, "rod", field) == pytest.approx(share, rel=1e-12)


def test_only_what_changes_a_transit_is_felt_in_steps():
    lines = load_case("li-ma-2019-fig13-bar", ["solver.method=delay lines", "solver.step=50 ns"])
    found = stairs(lines, ["load.peak", "stack.layer.upper.length", "stack.layer.upper.density"])
    assert found[0] == 0.0
    assert found[2] == pytest.approx(2.0 * found[1])
    assert stairs(DROP, ["machine.height", "stack.layer.upper.length"]) == [0.0, 0.0]
    assert stairs(load_case("two-bars-fem"), ["load.peak", "stack.layer.upper.length"]) == [0.0, 0.0]
    assert smooth_case(lines, ["stack.layer.upper.length"]) is lines
    assert smooth_case(BAR, ["load.peak", "stack.layer.upper.density"]).solver.method == "spectral"
    assert smooth_case(DROP, ["stack.layer.upper.length"]) is DROP


def test_two_to_twenty_choices_are_tried():
    assert read_tries(DROP, "contact.exponent = 1, 1.5 ,1") == ["contact.exponent=1", "contact.exponent=1.5"]
    assert len(read_tries(DROP, "exponent=" + ",".join(map(str, range(20))))) == 20
    for word in ("exponent=1", "exponent=1,1", "exponent=" + ",".join(map(str, range(21)))):
        with pytest.raises(InputError, match="2 to 20 choices"):
            read_tries(DROP, word)


@pytest.mark.parametrize(
    ("allowed", "scale"),
    [
        (Range("", 0.0, 1.0), False),
        (Range("", 0.0, 1.005), True),
        (Range("", 0.005, 1.0), True),
        (Range("m", 0.0, 1.0), True),
    ],
)
@pytest.mark.parametrize(("form", "factors"), [(None, True), ("factor", True), ("width", False)])
def test_factors_count_unless_a_field_is_a_share_or_has_a_plausible_width(monkeypatch, allowed, scale, form, factors):
    plausible = {} if form is None else {"machine.height": SimpleNamespace(form=form)}
    monkeypatch.setattr(free_fields_module, "PLAUSIBLE", plausible)
    monkeypatch.setattr(free_fields_module, "range_of", lambda case, path: allowed)
    assert free_fields_module._is_scale(DROP, "machine.height") == (scale and factors)


@pytest.mark.parametrize(("path", "hint"), [("object.friction", True), ("nothing.friction", False), ("contact", False)])
def test_a_field_that_a_case_may_have_is_told_to_be_given_a_start(path, hint):
    with pytest.raises(InputError) as error:
        free_fields(DROP, [path])
    assert ("give it a start" in str(error.value)) == hint


def test_a_scatter_is_stated_once(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="a share above 0"):
        parse_target("a.csv +- 2 % +- 3 %", DROP)
    with pytest.raises(InputError, match="a share above 0"):
        read_number(DROP, Target("first.width", "1 ms +- 2 % +- 3 %", is_number=True))
    assert read_number(DROP, Target("first.width", "10 ms", is_number=True)).value == 0.01


@pytest.mark.parametrize(("count", "words"), [(201, "201 records"), (200, "stopped here")])
def test_a_fit_reads_200_records_of_a_setting(monkeypatch, count, words):
    def stop(case, blows):
        raise InputError("x", "stopped here", "y")

    curves = [SimpleNamespace(notices=())] * count
    monkeypatch.setattr(targets_module, "read_shots", lambda option, word, reading: (curves, []))
    monkeypatch.setattr(targets_module, "quick_case", stop)
    with pytest.raises(InputError, match=words):
        read_targets("--to", DROP, [Target("", "a.csv")], (), SimpleNamespace(low_pass=None))


@pytest.mark.parametrize(("is_open", "low"), [(True, np.nextafter(0.0, 1.0)), (False, 0.0)])
def test_a_bound_that_is_not_allowed_itself_is_the_next_number(monkeypatch, is_open, low):
    monkeypatch.setattr(free_fields_module, "PLAUSIBLE", {})
    share = Range("", 0.0, 1.0, open_low=is_open)
    monkeypatch.setattr(free_fields_module, "range_of", lambda case, path: share)
    value = Value(si=0.3, typed=0.3)
    assert free_fields_module._bounds(DROP, "machine.height", value, share) == (low, 1.0)
    scale = Range("m", 0.0, 10.0, open_low=is_open)
    monkeypatch.setattr(free_fields_module, "range_of", lambda case, path: scale)
    assert free_fields_module._bounds(DROP, "machine.height", value, scale) == pytest.approx((0.03, 3.0))
