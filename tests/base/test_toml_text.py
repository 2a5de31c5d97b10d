"""A key of very many parts is refused before it is read, in every TOML file that a user hands over."""

import pytest

from strikewave.base.documents import MOST_PARTS, read_toml
from strikewave.base.errors import StrikewaveError

DEEP = ".".join(["a"] * 5000)
"""10 kB that take 150 MB; 80 kB would take 6 GB."""
FILES = {
    "a key": f"{DEEP} = 1",
    "a table": f"[{DEEP}]",
    "blanks and quotes": f"{DEEP}".replace(".a.", " . \"a\" .\t'a'.") + " = 1",
    "within a table of one line": f"b = {{ {DEEP} = 1 }}",
    "arrays in arrays": "a = " + "[" * 50_000,
}
REFUSED = "a key of many parts|nested too deeply"


@pytest.mark.parametrize("text", FILES.values(), ids=FILES)
@pytest.mark.parametrize("command", ["run", "wave", "fem", "hopkinson", "validate", "fit", "scatter"])
def test_every_command_refuses_a_key_of_many_parts(strikewave, tmp_path, command, text):
    (tmp_path / "deep.toml").write_text(f"schema = 1\n{text}\n")
    code, _, err = strikewave(command, "deep.toml")
    assert code == 2
    assert "a key of many parts" in err or "nested too deeply" in err


@pytest.mark.parametrize("text", FILES.values(), ids=FILES)
def test_calibrations_sensors_and_specifications_refuse_it_too(tmp_path, text):
    from strikewave.cases.files import read_small_file
    from strikewave.records.calibration import read_calibrations
    from strikewave.specifications.reading import parse_specification

    file = tmp_path / "deep.toml"
    file.write_text(text)
    for read in (
        lambda: read_calibrations(file),
        lambda: read_small_file(file, "FILE", "tables"),
        lambda: parse_specification(text, "deep.toml"),
    ):
        with pytest.raises(StrikewaveError, match=REFUSED):
            read()


def test_texts_and_numbers_with_many_dots_are_none():
    note = "Mean of A.B. et al., fig. 3.2 ... 1.5 mm; " * 40
    numbers = [k + 0.5 for k in range(200)]
    assert read_toml(f'note = "{note}"\nvalues = {numbers}') == {"note": note, "values": numbers}


def test_keys_of_as_many_parts_as_allowed_are_read():
    document = read_toml(".".join(["a"] * MOST_PARTS) + " = 1")
    for _ in range(MOST_PARTS):
        document = document["a"]
    assert document == 1


@pytest.mark.parametrize(
    "text", ["a" * 200_000, '"' * 200_000, "a." * 100_000 + "=", '"a' * 100_000, ("a" + ".b" * 39 + ",") * 3000]
)
def test_looking_for_such_keys_is_quick(text):
    """Texts at which a pattern that tries again would take minutes."""
    with pytest.raises(ValueError, match=r"."):
        read_toml(text)
