"""A sector of bodies and the whole bodies, meshed and run: the same numbers on every face but where it names the mesh."""

import contextlib
import dataclasses
import functools
import io
import os
import re
from unittest import mock

import numpy as np
import pytest

from strikewave import load_case
from strikewave.analyses.compare.simulated import arrays_curve
from strikewave.analyses.fem.report import fem_report, fem_words, picture
from strikewave.analyses.fem.run import run_fem
from strikewave.analyses.fem.screen import show
from strikewave.reporting.numbers import ShownUnits, showing
from strikewave.studies.simulation import Simulation, number_units
from strikewave.web.pages.case.elements_view import history_charts

CASE = """
schema = 1
name = "bars"
{parts}
[fem]
duration = "12 us"
interval = "0.5 us"
frames = 0
blows = 2
least_step = "120 ns"
[[fem.contact]]
first = "striker.z+"
second = "bar.z-"
[[fem.wall]]
side = "bar.z+"
point = {{ z = "30 mm" }}
normal = {{ z = -1 }}
[[fem.group]]
name = "both"
parts = ["striker", "bar"]
[[fem.section]]
name = "across"
part = "bar"
point = {{ z = "12.1 mm" }}
normal = "z"
[[fem.section]]
name = "along"
part = "bar"
point = {{ x = "0.9 mm" }}
normal = "x"
[[fem.point]]
name = "corner"
part = "bar"
place = {{ x = "2 mm", y = "2 mm", z = "20 mm" }}
{boundaries}
"""
PART = """
[[mesh.part]]
name = "{name}"
shape = "block"
width = "4 mm"
depth = "4 mm"
height = "{height}"
size = "1 mm"
sector = "{sector}"
{place}
[mesh.part.solid]
law = "bilinear"
density = "7800 kg/m^3"
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
yield_strength = "{strength}"
tangent_modulus = "2 GPa"
"""
CUTS = {"whole": [], "half": ["y-"], "quarter": ["x-", "y-"]}
PIECES = {"half": 2, "quarter": 4}
OF_THE_MESH = {"elements", "nodes", "steps", "seconds", "element_steps_per_second", "sectors"}
"""Keys beside those that begin with ``model_`` that say what is meshed."""
BALANCES = {"error", "energy_error", "momentum_error", "hourglass_share", "kinetic_share"}
"""Errors: rounding, not numbers of the bodies."""
SAME = 2e-3
"""Of the largest of a history or a number: the same elements, but sums run in another order and rounding decides when a
point of contact or of yield is reached; 1e-3 is the most that 144 steps of two blows came to."""
SUMS = {"peak", "impulse", "whole_peak", "whole_impulse", "mass", "whole_mass", "contact_force_peak", "added_mass"}
SUMS |= {"initial", "kinetic", "internal", "plastic", "contact", "viscous", "hourglass", "striker", "bar"}
"""Keys of numbers that are sums over a body; plastic energy is by part."""
TABLES = ("Contacts and walls", "Parts, each as one rigid body", "Forces of each blow")
NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e[-+]?\d+)?")


@functools.cache
def solution_of(sector, folder):
    rows = [("striker", "10 mm", 'velocity = { z = "40 m/s" }', "400 MPa")]
    rows += [("bar", "20 mm", 'at = { z = "10 mm" }', "300 MPa")]
    parts = "".join(PART.format(name=n, height=h, place=p, sector=sector, strength=s) for n, h, p, s in rows)
    cuts = [f'[[fem.boundary]]\nkind = "symmetry"\nside = "{n}.{c}"\n' for n, *_ in rows for c in CUTS[sector]]
    path = folder / f"{sector}.toml"
    path.write_text(CASE.format(parts=parts, boundaries="".join(cuts)))
    return run_fem(load_case(str(path)))


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sectors")
    return lambda sector: solution_of(sector, folder)


def leaves(value, path=""):
    """Yield every number of a document with its path."""
    if isinstance(value, dict):
        for key, inner in value.items():
            if key not in OF_THE_MESH | BALANCES and not key.startswith("model_"):
                yield from leaves(inner, f"{path}.{key}")
    elif isinstance(value, list):
        for place, inner in enumerate(value):
            yield from leaves(inner, f"{path}[{place}]")
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield path, np.asarray(float(value))


def of_json(solution):
    return dict(leaves(solution.content()))


def of_csv(solution):
    tables = {}
    for name, text in solution.tables().items():
        heads = text.splitlines()[0].split(",")
        rows = np.genfromtxt(io.StringIO(text), delimiter=",", skip_header=1)
        tables |= {f"{name} {head}": column for head, column in zip(heads, rows.T, strict=True)}
    return {name: column for name, column in tables.items() if "error" not in name}


def of_netcdf(solution):
    named = [
        (f"{file} {name}", v) for file, arrays in solution.datasets().items() for name, v in arrays.variables.items()
    ]
    shown = {name: v.values for name, v in named if " model_" not in name and not name.endswith(".error")}
    return {name: values for name, values in shown.items() if values.dtype.kind == "f"}


def of_picture(solution):
    figure = picture(solution)
    drawn = {(k, n): line for k, axes in enumerate(figure.axes) for n, line in enumerate(axes.lines)}
    return {
        f"axes {k} ({figure.axes[k].get_ylabel()}) line {n}": np.asarray(line.get_ydata(), float)
        for (k, n), line in drawn.items()
        if "error" not in figure.axes[k].get_ylabel()
    }


def of_app(solution):
    charts = history_charts(solution)
    return {f"{k} {line['name']}": np.array(line["data"], float) for k, x in enumerate(charts) for line in x["series"]}


def of_studies(solution):
    study = Simulation(solution.case)
    study.__dict__["elements"] = solution
    numbers = {
        (name, body): study.number(name, body)
        for name in number_units(solution.case)
        for body in ("bar", "striker")
        if name not in BALANCES
    }
    return {f"{name} {body}": np.asarray(value, float) for (name, body), value in numbers.items() if value is not None}


def of_compare(solution):
    parts = ("striker.z+-bar.z-", "bar.z+-wall", "bar", "both")
    curves = {part: arrays_curve("--to", "bars", solution.arrays, part, 0, "") for part in parts}
    return {part: np.asarray(curve.history.values) for part, curve in curves.items()}


def of_words(solution, page=""):
    """The screen, its first sentences, the head of a notebook, and the tables of a report."""
    screen = io.StringIO()
    with mock.patch.dict(os.environ, COLUMNS="300"), contextlib.redirect_stdout(screen):  # a minus sign moves no line
        show(solution)
    lines = [line for line in screen.getvalue().splitlines() if "balance" not in line and "steps" not in line]
    lines += [fem_words(solution).partition("The energy balance")[0]]
    lines += [f"{name} {value}" for name, value in solution.highlights() if name != "elements"]
    captions = [page.find(f"{name}<") for name in TABLES if page]
    lines += [re.sub(r"<[^>]*>", " ", page[at : page.index("</table>", at)]) for at in captions]
    errors = re.compile(r"[-+]?\d(\.\d+)?e-\d+")
    return {f"line {place}": np.array(NUMBER.findall(errors.sub("", x)), float) for place, x in enumerate(lines)}


FACES = (of_json, of_csv, of_netcdf, of_picture, of_app, of_studies, of_compare)


def scales(values):
    """Return what the numbers of each path are held against: the largest over all blows and components of its kind."""
    kinds = {}
    for name, array in values.items():
        kind = re.sub(r"\[\d+\]|-\d|[xyz]{1,2}(?= \[)", "", name)
        kinds[kind] = max(kinds.get(kind, 0.0), float(np.nan_to_num(np.abs(array)).max(initial=0.0)))
    return {name: kinds[re.sub(r"\[\d+\]|-\d|[xyz]{1,2}(?= \[)", "", name)] for name in values}


def differences(face, whole, sector):
    """Return where a face of two results differs."""
    expected, got = face(whole), face(sector)
    assert expected.keys() == got.keys()
    assert len(expected) > 3
    scale = scales(expected)
    return [
        name
        for name, values in expected.items()
        if got[name].shape != values.shape
        or not np.allclose(got[name], values, rtol=0.0, atol=SAME * max(scale[name], 1e-12), equal_nan=True)
    ]


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("sector", PIECES)
def test_a_sector_comes_to_the_numbers_of_the_whole_bodies_on_every_face(solved, sector, face):
    assert differences(face, solved("whole"), solved(sector)) == []


@pytest.mark.parametrize("sector", PIECES)
def test_the_screen_shows_the_numbers_of_whole_bodies(solved, sector):
    """Digit by digit: 5 of them at most, and a place may be in any of the sectors."""
    expected, got = of_words(solved("whole")), of_words(solved(sector))
    assert len(expected) > 40
    for line, values in expected.items():
        assert got[line] == pytest.approx(values, rel=SAME), line


@pytest.mark.verify
def test_the_report_shows_the_numbers_of_whole_bodies(solved):
    expected, got = (of_words(one, fem_report(one)) for one in (solved("whole"), solved("quarter")))
    assert len(expected) > len(of_words(solved("whole")))
    for line, values in expected.items():
        assert got[line] == pytest.approx(values, rel=SAME), line


@pytest.mark.usefixtures("undrawn")
def test_parts_and_their_solids_stand_on_the_page_in_the_chosen_units(solved):
    with showing(ShownUnits.read("Pa,km/h,gram/cm^3")):
        page = fem_report(solved("quarter"))
    heads = ("density (gram/cm³)", "E (Pa)", "initial velocity (km/h)")
    assert [head for head in heads if f">{head}<" not in page] == []


@pytest.mark.parametrize("face", FACES)
def test_the_walk_sees_a_face_that_is_made_of_the_sector(solved, face):
    """Each sum over a body differs where a face shows the run as meshed, and so does one at least on every face."""
    as_meshed = dataclasses.replace(
        solved("quarter"), run=solved("quarter").model_run, later=solved("quarter").modelled[1:]
    )
    seen = differences(face, solved("whole"), as_meshed)
    assert seen
    if face is of_json:
        keys = {name.rpartition(".")[2] for name in seen}
        assert keys >= SUMS
        document = as_meshed.content()
        zero = {name for name, value in solved("whole").content()["energy"].items() if not value}
        assert zero == {"external"}
        assert document["contact_force_peak"] == pytest.approx(solved("whole").contact_force_peak / 4.0, rel=0.01)


@pytest.mark.parametrize(("sector", "pieces"), PIECES.items())
def test_what_is_meshed_has_names_of_its_own(solved, sector, pieces):
    solution, document = solved(sector), solved(sector).content()
    for kind in ("parts", "groups"):
        for row in document[kind].values():
            assert row["sectors"] == pieces
            assert row["mass"] == row["whole_mass"] == pytest.approx(pieces * row["model_mass"], rel=1e-12)
    for row in document["contacts"].values():
        assert (row["whole_peak"], row["whole_impulse"]) == (row["peak"], row["impulse"])
        assert row["model_impulse"] == pytest.approx(row["impulse"] / pieces, rel=0.01)
    assert document["contact_force_peak"] > 1.9 * document["model_contact_force_peak"]
    assert document["added_mass"] == pieces * document["model_added_mass"] > 0.0
    for name, value in document["model_energy"].items():
        assert document["energy"][name] == pieces * value
    arrays = solution.arrays
    assert np.array_equal(arrays["model_energy.kinetic"].values * pieces, arrays["energy.kinetic"].values)
    assert np.array_equal(arrays["model_contact.bar.z+-wall.force"].values, solution.model_run.force["bar.z+-wall"])
    assert not [name for name in solved("whole").arrays.variables if name.startswith("model_")]
    assert f"Meshed is a {sector} of striker and bar" in fem_words(solution)
    assert "Meshed" not in fem_words(solved("whole"))
    assert set(solution.units()) >= {key for key in document if key.startswith("model_") and key != "model_energy"}


@pytest.mark.verify
def test_histories_kept_before_forces_were_of_whole_bodies_are_refused_where_a_sector_is_meshed(solved, tmp_path):
    from strikewave import InputError, compare

    file = tmp_path / "histories.nc"
    asked = f"{file}:bar"
    for sector in ("quarter", "whole"):
        for schema in (1, 2):
            solved(sector).arrays.with_attributes({"strikewave_schema": schema}).write(file)
            if (sector, schema) == ("quarter", 1):
                with pytest.raises(InputError, match="its forces are those of the meshed sector; run the case again"):
                    compare(asked, asked)
            else:
                assert compare(asked, asked).content()["metrics"]["peak"]["difference"] == 0.0
