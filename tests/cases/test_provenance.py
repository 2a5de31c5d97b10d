"""The provenance of a value stays true: of what a file changes, of what it types, through writing and reading."""

import pytest

from strikewave.cases.case import dump_case, load_case, own_case, parse_case
from strikewave.cases.files import bundled_cases

ORIGIN = "li-ma-2019"
MASS = (
    'mass = {value = "0.459 kg", provenance = "inferred", note = "19 685.34 N / 4 374.52 g of the paper\'s simulation"}'
)
"""The line of a file begun from the built-in case."""


def file_with(line, place=MASS, origin=ORIGIN):
    """Return a case whose file begins from a built-in one and has another line in the place of one."""
    text = dump_case(own_case(load_case(origin), "mine", origin))
    assert text.count(place) == 1
    return parse_case(text.replace(place, line))


@pytest.mark.parametrize(
    ("line", "provenance", "note"),
    [
        ('mass = "1.2 kg"', "user", ""),
        ('mass = "0.459 kg"', "inferred", ""),
        ('mass = "459 gram"', "inferred", ""),
        ('mass = {value = "1.2 kg", note = "weighed"}', "user", "weighed"),
        (MASS.replace("0.459 kg", "1.2 kg"), "user", ""),
        (MASS.replace("0.459 kg", "459 gram"), "inferred", "19 685.34 N / 4 374.52 g of the paper's simulation"),
        ('mass = {value = "1.2 kg", provenance = "measured"}', "measured", ""),
        ('mass = {value = "1.2 kg", provenance = "inferred", note = "force over peak"}', "inferred", "force over peak"),
        ('mass = {value = "0.459 kg", provenance = "user"}', "user", ""),
    ],
    ids=[
        *("typed alone", "typed as it was", "in another unit", "typed with a note", "the badge came along"),
        *("the badge, another unit", "said to be measured", "with a note of its own", "said to be the user's"),
    ],
)
def test_a_value_of_a_file_has_the_provenance_that_is_true_of_it(line, provenance, note):
    value = file_with(line).object.mass
    assert (value.provenance, value.note) == (provenance, note)


def test_a_value_that_is_changed_and_still_called_measured_needs_another_note():
    """Of the steel bar of 1983 the length is published; a badge and a note that came along are not the new length's."""
    text = dump_case(own_case(load_case("togami-1996-bar"), "mine", "togami-1996-bar"))
    old = load_case("togami-1996-bar").values()["stack.layer.bar.length"]
    changed = parse_case(text.replace(f'value = "{old.typed}", provenance = "{old.provenance}"', 'value = "1 m"', 1))
    assert changed.values()["stack.layer.bar.length"].provenance == "user"


def test_a_case_without_a_source_is_its_users():
    text = (
        'schema = 1\n[[stack.layer]]\nname = "a"\nmaterial = "65Mn"\nlength = "1 m"\n'
        'diameter = {value = "20 mm", provenance = "measured"}\n[load]\nshape = "half-sine"\npeak = "1 kN"\n'
        'duration = "20 us"\n[solver]\nduration = "1 ms"\n'
    )
    values = parse_case(text).values()
    assert values["stack.layer.a.length"].provenance == "user"
    assert values["stack.layer.a.diameter"].provenance == "measured"
    assert values["solver.tolerance"].provenance == "assumed"  # a default: nothing was typed


def test_a_row_that_is_renamed_is_held_against_the_row_in_its_place():
    origin = "li-ma-2019-fig5"
    text = dump_case(own_case(load_case(origin), "mine", origin)).replace('"specimen"', '"board"')
    kept = parse_case(text).values()["stack.layer.board.length"]
    changed = parse_case(text.replace('"85 mm"', '"80 mm"')).values()["stack.layer.board.length"]
    assert (kept.provenance, changed.provenance) == ("assumed", "user")


def test_written_cases_read_back_as_they_were(published):
    assert parse_case(dump_case(published)) == published


@pytest.mark.parametrize("changes", [["machine.speed=730 rpm"], ["striker.mass=2 kg", "compare=true"]])
def test_a_changed_case_reads_back_as_it_was(changes):
    case = load_case(ORIGIN, changes)
    assert parse_case(dump_case(case)) == case


def test_a_new_file_that_nobody_touched_is_its_origin_without_the_numbers_to_compare_with(published):
    own = parse_case(dump_case(own_case(published, "mine", published.name)))
    assert own.values() == published.values()
    assert own.changed_fields() == []
    assert own.published == ()


def test_a_built_in_case_is_its_own_source():
    assert {load_case(name).source == name for name in bundled_cases()} == {True}
