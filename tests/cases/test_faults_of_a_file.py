"""What is wrong with a case file, said so that its writer can mend it."""

import pytest

from strikewave.base.errors import InputError
from strikewave.cases.case import load_case, parse_case


def refusal(call, *given):
    with pytest.raises(InputError) as error:
        call(*given)
    return str(error.value)


@pytest.mark.parametrize(
    ("text", "words", "foreign"),
    [
        ("[machine]\n[object]\n[machine]\n", "the table [machine] stands there twice (at line 3, column 9)", "quotes"),
        ("a = 1\na = 2\n", "a key stands there twice (at line 2, column 6)", "quotes"),
        ("a = 1.2 m\n", "a value with a unit stands in quotes", "twice"),
        ("a = m\n", "values with a unit, stand in quotes", "twice"),
        ('a = "1.2 m\n', "a text is not closed by its quote (at line 1, column 11)", "twice"),
    ],
)
def test_a_fault_of_toml_names_the_file_and_the_hint_is_of_that_fault(tmp_path, text, words, foreign):
    path = tmp_path / "m4.toml"
    path.write_text(text)
    said = refusal(load_case, str(path))
    assert said.startswith(f"{path}: not a TOML file: ")
    assert words in said
    assert foreign not in said
    assert "(" not in said.split("(at")[0].removeprefix(str(path))  # no notation of Python's


def test_a_misspelt_file_names_the_one_beside_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sub").mkdir()
    for name in ("table-power.toml", "sub/other.toml"):
        (tmp_path / name).write_text("schema = 1\n")
    assert refusal(load_case, "tabel-power.toml") == (
        'no such file: tabel-power.toml; did you mean "table-power.toml"?'
    )
    assert 'did you mean "sub/other.toml"?' in refusal(load_case, "sub/othr.toml").replace("\\", "/")
    assert "`strikewave cases`" in refusal(load_case, "xyz.toml")
    assert "en-166-ball" not in refusal(load_case, "xyz.toml")  # who types a file looks for no built-in case
    assert 'did you mean "li-ma-2019"' in refusal(load_case, "li-ma-2020")


def test_a_key_of_another_kind_of_machine_is_said_to_be_one():
    said = refusal(load_case, "jesd22-b111-b", ["machine.angle=30 deg"])
    assert said == "machine.angle: unknown key; it is a key of pendulum, and this is drop"
    assert 'did you mean "height"?' in refusal(load_case, "jesd22-b111-b", ["machine.hieght=1 m"])


def test_a_drop_height_is_asked_for_by_a_height_of_a_drop():
    for height in ("1,2 m", "1.2", "1.2 kg"):
        text = f'schema = 1\n[machine]\nkind = "drop"\nfollow = "2 ms"\nheight = "{height}"\n'
        assert "machine.height: got" in (said := refusal(parse_case, text))
        assert 'a length with its unit, such as "1.2 m"' in said
    missing = refusal(parse_case, 'schema = 1\n[machine]\nkind = "drop"\nfollow = "2 ms"\n')
    assert 'machine.height: missing; add height = "1.2 m"' in missing


@pytest.mark.parametrize(
    ("typed", "hint"),
    [
        ("1,2 m", 'write a decimal point, not a comma: "1.2 m"'),
        ("1,200 m", 'a comma may mean either: write "1.200 m" or "1200 m"'),
        ("1,2,3 m", "write one number, then its unit"),
    ],
)
def test_a_decimal_comma_is_named(typed, hint):
    assert hint in refusal(load_case, "jesd22-b111-b", [f"machine.height={typed}"])
