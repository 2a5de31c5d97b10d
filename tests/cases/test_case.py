"""Case files: round trips, provenance, and bad input, one line each."""

import html
import tomllib
from importlib import resources

import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.analyses.by_tables import check_case
from strikewave.analyses.machine.build import build_machine
from strikewave.base.errors import InputError, InputErrors
from strikewave.base.quantities import PROVENANCES
from strikewave.cases.case import FORM, document_of, dump_case, load_case, parse_case
from strikewave.cases.files import bundled_cases


@pytest.mark.parametrize("name", bundled_cases())
def test_every_published_case_reads_writes_and_builds(name):
    case = load_case(name)
    assert parse_case(dump_case(case)) == case
    check_case(case)


@pytest.mark.parametrize("name", bundled_cases())
def test_a_case_shows_itself_in_one_line_and_in_a_notebook_as_its_file(name):
    case = load_case(name)
    assert repr(case).startswith(f"<Case {name}: {case.title}; ")
    assert len(repr(case)) < 250
    assert html.unescape(case._repr_html_()).count(dump_case(case)) == 1


def test_a_changed_case_shows_the_fields_in_which_it_differs():
    """Its title is that of the built-in case, which a change makes untrue."""
    case = load_case("li-ma-2019", ["machine.speed=500 rpm"])
    assert repr(case).endswith("published; differs from li-ma-2019 in machine.speed>")
    assert "differs from li-ma-2019 in machine.speed)" in case._repr_html_()


def test_the_html_of_a_case_holds_no_mark_of_the_file():
    case = parse_case(dump_case(load_case("en-166-ball")).replace('title = "', 'title = "<script>'))
    assert "<script>" in case.title
    assert "<script>" not in case._repr_html_()


def test_a_written_case_has_the_same_numbers_to_the_last_bit(published):
    again = parse_case(dump_case(published))
    assert {p: v.si for p, v in again.values().items()} == {p: v.si for p, v in published.values().items()}


def test_every_value_of_the_published_case_says_where_it_comes_from():
    case = load_case("li-ma-2019")
    text = (resources.files("strikewave.cases") / "published" / "li-ma-2019.toml").read_text()
    document = tomllib.loads(text)
    for table in ("machine", "striker", "feed", "object", "contact", "recorder"):
        for key, raw in document[table].items():
            if not isinstance(raw, str):
                assert raw["provenance"] in PROVENANCES, (table, key)
    assert case.fitted_fields() == ["machine.engagement", "object.frame_stiffness"]
    assert case.values()["machine.speed"].provenance == "published"


def test_a_changed_value_is_the_user_s():
    case = load_case("li-ma-2019", ["machine.engagement=4 mm"])
    value = case.values()["machine.engagement"]
    assert (value.si, value.provenance, value.note) == (0.004, "user", "")
    assert case.fitted_fields() == ["object.frame_stiffness"]


def test_a_bare_number_is_si_on_the_command_line_only():
    assert load_case("li-ma-2019", ["machine.speed=76.4"]).machine.speed.si == 76.4
    with pytest.raises(InputErrors, match='write "730 rad/s" if that is meant'):
        parse_case(edited("machine", "speed", 730))


def edited(table, key, value, remove=False):
    """The published case as TOML text with one key changed or removed."""
    import tomlkit

    document = document_of(load_case("li-ma-2019"))
    place = document if table is None else document.setdefault(table, {})
    if remove:
        del place[key]
    else:
        place[key] = value
    return tomlkit.dumps(document)


BAD_VALUES = [
    ("machine", "speed", 730, "bare number"),
    ("machine", "speed", "730", "bare number"),
    ("machine", "speed", "730 kg", "is not a speed of rotation"),
    ("machine", "speed", "730 rpn", 'did you mean "rpm"'),
    ("machine", "speed", "-730 rpm", "above 0"),
    ("machine", "speed", "0 rpm", "above 0"),
    ("machine", "speed", "1e400 rpm", "not finite"),
    ("machine", "speed", "fast", "one number, then its unit"),
    ("machine", "speed", True, "a speed of rotation"),
    ("machine", "speed", ["730 rpm"], "a speed of rotation"),
    ("machine", "speed", {"provenance": "assumed"}, "give the table a value"),
    ("machine", "speed", {"value": "730 rpm", "provenance": "guessed"}, "one of published, measured"),
    ("machine", "speed", {"value": "730 rpm", "provenence": "assumed"}, 'did you mean "provenance"'),
    ("machine", "speed", {"value": "730 rpm", "note": 3}, "text"),
    ("machine", "strikers", 2.5, "a whole number"),
    ("machine", "strikers", 0, "at least 1"),
    ("machine", "strikers", 1000, "at most 100"),
    ("machine", "strikers", "four", "no unit"),
    ("machine", "kind", "rotry", "'rotary'"),
    ("machine", "sped", "1 rpm", 'did you mean "speed"'),
    ("object", "mass", "459 g", "write gram or kg"),
    ("contact", "restitution", 1.2, "at most 1"),
    ("contact", "restitution", 0.0, "at least 0.01"),
    ("feed", "arrival", -0.1, "at least 0"),
    ("feed", "blows", 0, "at least 1"),
    ("solver", "tolerance", 1.0, "at most 1e-05"),
    ("recorder", "memory", 1e12, "at most 1e+07"),
    ("engine", "speed", "1 rpm", "unknown key"),
    ("contact", "restitution", 10**400, "a number"),
    (None, "name", "../../evil", "letters, digits"),
    (
        None,
        "published",
        [{"quantity": [1], "value": "1 g", "origin": "measured", "role": "shown"}],
        "a computed quantity",
    ),
    (None, "published", [{"quantity": "count", "value": 0, "origin": "measured", "role": "shown"}], "above 0"),
]


@pytest.mark.parametrize(("table", "key", "value", "words"), BAD_VALUES)
def test_bad_values_are_refused_with_path_and_remedy(table, key, value, words):
    with pytest.raises(InputErrors) as caught:
        parse_case(edited(table, key, value))
    (line,) = caught.value.lines
    assert line.startswith(table or key)
    assert words in line


@pytest.mark.parametrize(("table", "key"), [(None, "machine"), ("machine", "speed"), ("feed", "blows")])
def test_what_is_missing_is_named_with_an_example(table, key):
    with pytest.raises(InputErrors, match=f"{key}: missing; add "):
        parse_case(edited(table, key, None, remove=True))


@pytest.mark.parametrize(
    ("schema", "words"),
    [(None, "begin the case file"), (2, "newer strikewave"), (0, "schema = 1"), ("1", "schema = 1")],
)
def test_other_schemas_are_refused_with_a_word(schema, words):
    text = edited(None, "schema", schema, remove=schema is None)
    with pytest.raises(InputError, match=words):
        parse_case(text)


MISFITS = [
    ("object.nose_mass=1 kg", "object.nose_mass"),
    ("machine.engagement=300 mm", "machine.engagement"),
    ("object.preload=1 N", "object.preload"),
    ("feed.stroke=1 mm", "feed.stroke"),
    ("machine.torque=1 N m", "machine.torque"),
    ("machine.inertia=0.01 kg m^2", "machine.inertia"),
    ("machine.engagement=100 mm", "half a pitch"),
    ("machine.speed=2 rpm", "striking interval"),
    ("striker.mount_stiffness=10 kN/m", "hold the striker"),
    ("object.frame_stiffness=1 kN/m", "carry the nose"),
    ("solver.output_step=0.1 us", "below 2e"),
    ("striker.material=unobtainium", "striker.material"),
    ("contact.law=palmgrn", 'did you mean "palmgren"'),
    ("contact.damping=exat", 'did you mean "exact"'),
]


@pytest.mark.parametrize(("change", "words"), MISFITS)
def test_values_that_do_not_fit_together_are_refused(change, words):
    with pytest.raises(InputError, match=words.replace("?", r"\?")):
        build_machine(load_case("li-ma-2019", [change]))


@pytest.mark.parametrize(
    ("case", "field", "typed", "meant"),
    [
        ("li-ma-2019", "contact.damping", "exat", "exact"),
        ("li-ma-2019", "contact.law", "palmgrn", "palmgren"),
        ("iec-60068-2-27-rubber", "contact.cushion.law", "elastomr", "elastomer"),
    ],
)
def test_a_misspelt_law_is_refused_where_the_case_is_read(case, field, typed, meant):
    with pytest.raises(InputError, match=f'{field}: got "{typed}".*; did you mean "{meant}"'):
        load_case(case, [f"{field}={typed}"])


def test_what_catches_one_fault_of_a_case_catches_several():
    with pytest.raises(InputError, match=r"striker\.mas: unknown key") as refused:
        parse_case("schema = 1\n[striker]\nmas = '1 kg'\nnose = 3\n")
    assert len(refused.value.lines) > 1


@pytest.mark.parametrize("text", ["", "schema", "schema = 1\n[[", "\x00", "[a]\n" * 3, "schema = 1\nx = " + "[" * 5000])
def test_what_is_no_toml_is_refused(text):
    with pytest.raises(InputError):
        parse_case(text)


def test_files_that_are_no_case_are_refused(tmp_path):
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "large.toml").write_bytes(b"#" * 1_000_001)
    for name, words in (("binary.toml", "UTF-8"), ("large.toml", "at most 1000 kB"), ("absent.toml", "no such file: ")):
        with pytest.raises(InputError, match=words):
            load_case(str(tmp_path / name))
    with pytest.raises(InputError, match='did you mean "li-ma-2019"'):
        load_case("li-ma-2020")


@given(st.dictionaries(st.text(max_size=8), st.one_of(st.integers(), st.floats(), st.text(max_size=8), st.booleans())))
def test_any_table_is_read_or_refused(table):
    try:
        FORM.read({"schema": 1, "machine": table})
    except InputErrors as error:
        assert all("\n" not in line for line in error.lines)


BAR = """schema = 1
[[stack.layer]]
name = "upper"
material = "45 steel"
length = "0.1 m"
diameter = "20 mm"
[[stack.layer]]
name = "lower"
material = "45 steel"
length = "0.1 m"
diameter = "20 mm"
[[stack.joint]]
after = "upper"
kind = "compliant"
stiffness = "1 GN/m"
[load]
shape = "half-sine"
peak = "1 kN"
duration = "100 us"
"""


@pytest.mark.parametrize(
    ("old", "new", "field"),
    [
        ('"1 GN/m"', '"1 GN"', "stack.joint.upper.stiffness"),  # refused where the case is read
        ('stiffness = "1 GN/m"', "", "stack.joint.upper.stiffness"),  # refused where the bar is built
        ('after = "upper"', "after = 3", "stack.joint.0.after"),  # what is wrong is no name
        (
            'name = "lower"\nmaterial = "45 steel"\nlength = "0.1 m"',
            'name = "upper"\nlength = "1 s"',
            "stack.layer.1.length",
        ),
        ('name = "lower"', 'name = "a.b"\nlenght = "1 m"', "stack.layer.1.lenght"),  # a name that would be two places
    ],
)
def test_a_fault_names_a_row_by_a_name_of_its_own_whether_reading_or_building_finds_it(old, new, field):
    with pytest.raises(InputError) as error:
        check_case(parse_case(BAR.replace(old, new), "bar"))
    assert field in [line.partition(":")[0] for line in str(error.value).splitlines()]
