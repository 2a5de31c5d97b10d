"""Budget files: what they state reaches the contributions, and wrong ones are refused in one line."""

import math
from pathlib import Path
from typing import get_args

import pytest

from strikewave.base.errors import InputError
from strikewave.records.budget import KINDS as CHANGES
from strikewave.records.budget import TOPICS
from strikewave.specifications.budget_file import FIELDS_OF_KINDS, ContributionTable, Kind, load_budget

HEAD = 'schema = 1\ntitle = "t"\nstatus = "normative"\nsource = "certificate 17"\n'


def _one(**fields):
    rows = "".join(f"{key} = {value}\n" for key, value in fields.items())
    return f"{HEAD}[[contribution]]\n{rows}"


SENSITIVITY = {"kind": '"sensitivity"', "value": '"2 %"', "coverage": "2"}

WRONG = {
    "not TOML": ("schema = ", "needed: a share such as"),
    "a newer schema": (_one(**SENSITIVITY).replace("schema = 1", "schema = 2"), "schema: got 2"),
    "no title": (_one(**SENSITIVITY).replace('title = "t"\n', ""), "title: missing"),
    "no status": (_one(**SENSITIVITY).replace('status = "normative"\n', ""), "status: missing"),
    "no source": (
        _one(**SENSITIVITY).replace('source = "certificate 17"\n', ""),
        "source: missing; needed: who has it",
    ),
    "no contribution": (HEAD, "contribution: missing"),
    "none in the array": (HEAD + "contribution = []\n", "contribution: got"),
    "an unknown kind": (_one(**SENSITIVITY | {"kind": '"sensitivty"'}), 'kind: got "sensitivty"'),
    "an unknown key": (_one(**SENSITIVITY, covrage="2"), 'covrage: unknown key; did you mean "coverage"?'),
    "neither coverage nor distribution": (
        _one(kind='"clock"', value='"1 %"'),
        "coverage: missing; needed: coverage = 2",
    ),
    "normal without coverage": (_one(kind='"clock"', value='"1 %"', distribution='"normal"'), "coverage: missing"),
    "both": (_one(**SENSITIVITY, distribution='"rectangular"'), "normal beside coverage"),
    "an unknown distribution": (
        _one(kind='"clock"', value='"1 %"', distribution='"uniform"'),
        'distribution: got "uniform"',
    ),
    "a bare number in place of a share": (_one(**SENSITIVITY | {"value": '"2"'}), "value: got"),
    "an amount of a gain": (_one(**SENSITIVITY | {"value": '"2 g"'}), 'a share with kind sensitivity, such as "2 %"'),
    "more than all": (_one(**SENSITIVITY | {"value": '"200 %"'}), "from 0 to 100 %"),
    "less than nothing": (_one(**SENSITIVITY | {"value": '"-2 %"'}), "value: got"),
    "a filter without its cutoff": (
        _one(kind='"filter"', value='"10 %"', distribution='"rectangular"', order="4"),
        "cutoff: missing; needed: with kind filter: value, cutoff, order",
    ),
    "a cutoff of a gain": (_one(**SENSITIVITY, cutoff='"1 kHz"'), "with kind sensitivity only value"),
    "a resonance with a coverage": (
        _one(kind='"resonance"', frequency='"40 kHz"', quality="30", coverage="2"),
        "coverage: got 2; allowed: none with kind resonance",
    ),
    "a response that goes back": (
        _one(kind='"response"', distribution='"rectangular"', bands='[["10 kHz", "5 %"], ["1 kHz", "1 %"]]'),
        "frequencies upwards",
    ),
    "a response of one frequency": (
        _one(kind='"response"', distribution='"rectangular"', bands='[["10 kHz", "5 %"]]'),
        "2 to 200",
    ),
    "a time for a frequency": (_one(kind='"resonance"', frequency='"40 us"', quality="30"), "frequency: got"),
    "two of one name": (
        _one(**SENSITIVITY) + "[[contribution]]\n" + _one(**SENSITIVITY).split("]]\n")[1],
        "a name for each",
    ),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_wrong_budgets_are_refused_in_one_line(wrong, tmp_path):
    text, words = WRONG[wrong]
    file = tmp_path / "budget.toml"
    file.write_text(text)
    with pytest.raises(InputError) as error:
        load_budget(str(file))
    lines = str(error.value).splitlines()
    assert any(words in line and line.startswith("--uncertainty") for line in lines), lines


@pytest.mark.parametrize("word", ["five", "0 %", "150 %", "", "nan", "5 g", "no-such.toml", "0.05", "5"])
def test_what_is_neither_share_nor_file_is_refused(word):
    with pytest.raises(InputError, match="uncertainty"):
        load_budget(word)


def test_each_kind_reaches_its_contribution(tmp_path):
    file = tmp_path / "budget.toml"
    rows = [
        'kind = "sensitivity"\nvalue = "2 %"\ncoverage = 2',
        'kind = "temperature"\nper_kelvin = "0.1 %"\nrange = "10 K"\ndistribution = "rectangular"',
        'kind = "transverse"\nvalue = "3 %"\nmotion = "30 %"',
        'kind = "response"\nbands = [["1 kHz", "1 %"], ["10 kHz", "5 %"]]\ndistribution = "rectangular"',
        'kind = "resonance"\nfrequency = "40 kHz"\nquality = 30\nstatus = "quoted"\nsource = "data sheet, by a dealer"',
        'kind = "filter"\nvalue = "10 %"\ncutoff = "20 kHz"\norder = 4\ndistribution = "triangular"',
        'kind = "offset"\nvalue = "5 g"\ndistribution = "rectangular"',
        'kind = "drift"\nvalue = { value = "1 %", status = "indicative" }\ndistribution = "rectangular"',
        'kind = "coupling"\ntime_constant = "1 s"',
    ]
    file.write_text(HEAD + "".join(f"[[contribution]]\n{row}\n" for row in rows))
    budget = load_budget(str(file))
    by_kind = {one.kind: one for one in budget.contributions}
    assert set(FIELDS_OF_KINDS) <= set(by_kind)
    assert by_kind["sensitivity"].input.standard == 0.01
    assert by_kind["temperature"].input.standard == pytest.approx(0.01 / math.sqrt(3.0))
    assert by_kind["transverse"].input.standard == pytest.approx(0.03 * 0.3 / math.sqrt(2.0))
    assert by_kind["response"].tolerances == ((1e3, 0.01), (1e4, 0.05))
    assert (by_kind["resonance"].frequency, by_kind["resonance"].quality) == (4e4, 30.0)
    assert (by_kind["resonance"].status, by_kind["resonance"].source) == ("quoted", "data sheet, by a dealer")
    assert (by_kind["filter"].frequency, by_kind["filter"].order) == (2e4, 4.0)
    assert (by_kind["offset"].spread, by_kind["offset"].relative) == (pytest.approx(5 * 9.80665), False)
    assert by_kind["drift"].relative
    assert by_kind["drift"].status == "indicative"
    assert by_kind["coupling"].time_constant == 1.0
    assert budget.not_stated == ("gain of amplifier and recorder", "amplitude linearity", "clock of the recorder")


def test_each_kind_changes_a_record_is_listed_and_stands_in_the_docs():
    kinds = set(get_args(Kind))
    assert kinds <= set(CHANGES)
    assert kinds - {"noise"} == {kind for some in TOPICS.values() for kind in some}
    page = (Path(__file__).parents[2] / "docs" / "uncertainty.md").read_text("utf-8")
    assert [kind for kind in sorted(kinds) if f"| `{kind}`" not in page and f", `{kind}` |" not in page] == []


def test_every_field_of_a_kind_is_one_of_the_table():
    assert {name for fields in FIELDS_OF_KINDS.values() for name in fields.needs} <= set(ContributionTable.model_fields)


@pytest.mark.parametrize(
    ("fields", "spread", "relative"),
    [
        ({"kind": '"offset"', "value": '"0.0005 m/s^2"'}, 0.0005, False),
        ({"kind": '"clock"', "value": '"0.5 %"'}, 0.005, True),
        ({"kind": '"clock"', "value": '"100 %"'}, 1.0, True),
        ({"kind": '"temperature"', "per_kelvin": '"0.2 %"', "range": '"3 K"'}, 0.006, True),
        ({"kind": '"noise"', "value": '"9.9e6 m/s^2"'}, 9.9e6, False),
    ],
)
def test_small_and_large_numbers_are_taken_as_they_are(fields, spread, relative, tmp_path):
    file = tmp_path / "budget.toml"
    file.write_text(_one(**fields, distribution='"rectangular"'))
    [one] = load_budget(str(file)).contributions
    assert (one.spread, one.relative) == (pytest.approx(spread, rel=1e-12), relative)


def test_what_is_typed_is_told_up_to_four_numbers_with_the_weakest_status(tmp_path):
    file = tmp_path / "budget.toml"
    bands = '[["1 kHz", "1 %"], ["2 kHz", { value = "2 %", status = "indicative" }], ["3 kHz", "3 %"]]'
    file.write_text(
        _one(kind='"response"', bands=bands, distribution='"rectangular"')
        + "[[contribution]]\n"
        + _one(**SENSITIVITY | {"coverage": "4"}).split("]]\n")[1]
    )
    response, gain = load_budget(str(file)).contributions
    assert (response.typed, response.status) == ("1 kHz, 1 %, 2 kHz, 2 %, ...", "indicative")
    assert (gain.typed, gain.status, gain.spread) == ("2 %, k = 4", "normative", 0.005)
    assert math.isnan(gain.frequency)
    for word, share in (("99 %", 0.495), ("0.2 %", 0.001)):
        assert load_budget(word).contributions[0].spread == pytest.approx(share, rel=1e-12)
    for word in ("100 %", "0 %"):
        with pytest.raises(InputError):
            load_budget(word)


def _contributions(tmp_path, *rows):
    file = tmp_path / "budget.toml"
    file.write_text(HEAD + "".join(f"[[contribution]]\n{row}\n" for row in rows))
    return load_budget(str(file)).contributions


def test_the_status_of_a_contribution_is_the_weakest_of_all_its_numbers(tmp_path):
    """The order of a filter and a time constant have one too; what is no share of itself has a spread of 1."""
    filter_, coupling, resonance, response = _contributions(
        tmp_path,
        'kind = "filter"\nvalue = "10 %"\ncutoff = "20 kHz"\norder = { value = 4, status = "indicative" }\ncoverage = 2',
        'kind = "coupling"\ntime_constant = { value = "1 s", status = "indicative" }',
        'kind = "resonance"\nfrequency = "40 kHz"\nquality = 30',
        'kind = "response"\nbands = [["1 kHz", "1 %"], ["10 kHz", "5 %"]]\ndistribution = "triangular"',
    )
    assert [one.status for one in (filter_, coupling, resonance, response)] == [
        "indicative",
        "indicative",
        "normative",
        "normative",
    ]
    assert (filter_.typed, filter_.order, filter_.spread) == ("10 %, 20 kHz, 4, k = 2", 4.0, 0.05)
    assert (coupling.typed, coupling.spread, coupling.relative) == ("1 s", 1.0, True)
    assert (resonance.typed, resonance.spread, resonance.relative) == ("40 kHz, 30", 1.0, True)
    assert response.typed == "1 kHz, 1 %, 10 kHz, 5 %"
    shapes = [one.distribution for one in (filter_, coupling, resonance, response)]
    assert shapes == ["normal", "rectangular", "rectangular", "triangular"]
    assert [one.kind for one in (filter_, coupling)] == [one.name for one in (filter_, coupling)]


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ('kind = "offset"\nvalue = "1.005e7 m/s^2"\ndistribution = "rectangular"', "value: got"),
        ('kind = "clock"\nvalue = "100.5 %"\ndistribution = "rectangular"', "from 0 to 100 %"),
        (
            'kind = "response"\nbands = [["1 kHz", "1 %", "2 %"], ["2 kHz", "1 %"]]\ndistribution = "rectangular"',
            "pairs of",
        ),
        ('kind = "response"\nbands = ["1k", "2k"]\ndistribution = "rectangular"', "pairs of"),
        ('kind = "response"\nbands = [1, 2]\ndistribution = "rectangular"', "pairs of"),
        ('kind = "response"\nbands = "1 kHz"\ndistribution = "rectangular"', "pairs of"),
        ('kind = "response"\nbands = [["1 kHz", "1 %"], ["1 kHz", "2 %"]]\ndistribution = "rectangular"', "upwards"),
        ('kind = "clock"\nname = "noise and baseline"\nvalue = "1 %"\ndistribution = "rectangular"', "another name"),
    ],
)
def test_numbers_beyond_their_limits_are_refused(row, words, tmp_path):
    with pytest.raises(InputError) as error:
        _contributions(tmp_path, row)
    assert words in str(error.value)


@pytest.mark.parametrize(("bands", "tables", "taken"), [(200, 100, True), (201, 1, False), (2, 101, False)])
def test_a_budget_has_a_hundred_contributions_and_a_response_200_frequencies_at_most(bands, tables, taken, tmp_path):
    pairs = ", ".join(f'["{k + 1} kHz", "1 %"]' for k in range(bands))
    rows = [f'kind = "response"\nbands = [{pairs}]\ndistribution = "rectangular"']
    rows += [f'kind = "clock"\nname = "c{k}"\nvalue = "1 %"\ncoverage = 2' for k in range(tables - 1)]
    if taken:
        assert len(_contributions(tmp_path, *rows)) == tables
    else:
        with pytest.raises(InputError, match=f"{bands} pairs" if bands > 200 else "101 tables"):
            _contributions(tmp_path, *rows)


def test_small_shares_are_taken():
    assert load_budget("0.005 %").contributions[0].spread == pytest.approx(2.5e-5, rel=1e-12)
