"""What every kind of machine says of itself: words, settings, sources, a drawing whose numbers are those of the case."""

import subprocess
import sys

import pytest

from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.kind import LaunchedKind, MachineKind, kind_of
from strikewave.base.citations import SOURCES
from strikewave.base.errors import InputError
from strikewave.cases.case import load_case, parse_case
from strikewave.cases.files import bundled_cases, read_case_text
from strikewave.cases.tables.machine_kinds import KINDS

LAUNCHED = [name for name in bundled_cases() if load_case(name).launched() is not None]
RESERVOIR = 'pressure = "6 bar"\nvolume = "5000 cm^3"\nbore = "25 mm"\nlength = "1 m"'


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_has_its_words_settings_and_sources(kind):
    table = KINDS[kind]
    assert issubclass(table, MachineKind)
    assert table.__doc__.startswith("[machine]: ")
    assert table.description.endswith(".")
    assert len(table.chain) > 2
    assert set(table.settings) <= set(table.model_fields)
    assert set(table.sources) <= set(SOURCES)


def test_every_kind_has_a_case_and_every_launched_case_is_built():
    assert {load_case(name).machine.kind for name in LAUNCHED} | {"rotary"} == set(KINDS)
    for name in LAUNCHED:
        assert build_machine(load_case(name)).launch is not None


@pytest.mark.parametrize("name", LAUNCHED)
def test_a_schematic_shows_masses_and_what_it_is_not(name):
    case = load_case(name)
    (picture,), parts = kind_of(case).drawing(case)
    numbers = [one for part in parts for one in part.entries]
    mass = case.striker.mass.si
    assert any(one.shown in (f"{mass:.4g} kg", f"{mass * 1e3:.4g} g") for one in numbers)
    assert "not to scale" in picture.caption
    counted = int(picture.label.rpartition("Of the ")[2].split()[0])
    assert counted == sum(one.provenance != "computed" for one in numbers)


@pytest.mark.parametrize("name", LAUNCHED)
def test_a_schematic_numbers_each_part_once(name):
    case = load_case(name)
    (picture,), parts = kind_of(case).drawing(case)
    shown = [text.get_text() for axes in picture.figure.axes for text in axes.texts]
    assert sorted(word for word in shown if word.isdigit()) == sorted(str(k) for k in range(1, len(parts) + 1))


def test_a_pressed_gun_is_drawn_with_its_reservoir():
    text, name = read_case_text("en-166-ball")
    line = next(line for line in text.splitlines() if line.startswith("speed"))
    case = parse_case(text.replace(line, RESERVOIR), name)
    numbers = [one.shown for part in kind_of(case).drawing(case).parts for one in part.entries]
    assert {"5000 cm³", "6 bar", "25 mm"} <= set(numbers)


def test_a_case_without_a_machine_is_of_no_kind():
    with pytest.raises(InputError, match="machine: missing"):
        kind_of(load_case("togami-1996-bar"))


def test_reading_a_case_takes_no_physics():
    """The folder of kinds is read with every case: no kernels, no pictures."""
    code = (
        "import sys; from strikewave.cases.case import load_case; load_case('jesd22-b111-b');"
        "print(sorted({'numba', 'matplotlib', 'strikewave.machines'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.verify
@pytest.mark.parametrize("kind", [kind for kind in KINDS if issubclass(KINDS[kind], LaunchedKind)])
def test_a_kind_can_be_imported_before_any_case(kind):
    module = KINDS[kind].__module__
    subprocess.run([sys.executable, "-c", f"import {module}"], check=True, capture_output=True)
