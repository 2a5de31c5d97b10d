"""The folder that a command chooses by itself holds the result of one input, and is not taken by that of another."""

import os
import shutil
from pathlib import Path

import pytest

from strikewave.base.errors import InputError
from strikewave.reporting.output_options import check_inputs, origin_text, working_on


def result_of(folder, *inputs):
    """A folder as a run of these inputs leaves it."""
    folder.mkdir(parents=True)
    (folder / "case.toml").write_text("schema = 1\n")
    with working_on(inputs):
        (folder / "record.toml").write_text(origin_text("strikewave run"))


@pytest.mark.parametrize(
    ("before", "now", "refused"),
    [
        (["a.toml"], ["a.toml"], ""),
        (["a.toml"], ["./a.toml"], ""),  # one file, typed in another way
        (["a.toml"], [os.path.abspath("a.toml")], ""),
        (["a.toml"], ["b/a.toml"], '"a.toml"'),
        (["li-ma-2019"], ["li-ma-2019.toml"], '"li-ma-2019"'),
        (["1.csv", "2.csv"], ["1.csv", "2.csv", "3.csv"], ""),  # one blow more of the same campaign
        (["1.csv", "2.csv"], ["1.csv"], ""),
        (["d1/a.csv", "model.toml"], ["d2/a.csv", "model.toml"], '"d1/a.csv"'),  # a comparison of another record
        (["1.csv", "2.csv", "3.csv"], ["4.csv"], '"1.csv", "2.csv" and 1 more'),
        ([], ["a.toml"], ""),  # an older result does not say of what it is
        (["a.toml"], [], ""),  # a call in Python
    ],
)
def test_a_folder_is_kept_from_the_result_of_another_input(tmp_path, before, now, refused):
    result_of(tmp_path / "out", *before)
    with working_on(now):
        if not refused:
            check_inputs(tmp_path / "out", "schema = 2\n")
            return
        with pytest.raises(InputError) as error:
            check_inputs(tmp_path / "out", "schema = 2\n")
    assert f"the result of {refused};" in str(error.value)
    assert "--out DIR" in str(error.value)
    assert "--force" in str(error.value)


def test_the_very_same_result_is_replaced_from_wherever_it_was_asked(tmp_path):
    result_of(tmp_path / "out", "a.toml")
    with working_on(["copy.toml"]):
        check_inputs(tmp_path / "out", "schema = 1\n")


def test_a_case_edited_in_its_result_runs_again_into_that_folder(tmp_path):
    result_of(tmp_path / "out", "a.toml")
    with working_on([str(tmp_path / "out" / "case.toml")]):
        check_inputs(tmp_path / "out", "schema = 2\n")


@pytest.mark.parametrize("text", ["", "input = 3", "input = [3]", 'input = "a"', "[", "\xff"])
def test_a_damaged_origin_says_nothing(tmp_path, text):
    result_of(tmp_path / "out")
    (tmp_path / "out" / "record.toml").write_text(text, "latin-1")
    with working_on(["a.toml"]):
        check_inputs(tmp_path / "out", None)


CASE = """\
schema = 1
name = "bar"
[[stack.layer]]
name = "steel"
density = "7850 kg/m3"
modulus = "210 GPa"
length = "50 mm"
diameter = "20 mm"
[load]
shape = "half-sine"
peak = "1 kN"
duration = "50 us"
[solver]
duration = "{duration}"
"""


@pytest.mark.usefixtures("undrawn")
def test_two_cases_of_one_name_do_not_share_a_folder_in_silence(strikewave):
    """An edited case runs again into its folder; another file whose case has the same name is refused."""
    for name, duration in (("one.toml", "100 us"), ("one.toml", "120 us"), ("two.toml", "140 us")):
        Path(name).write_text(CASE.format(duration=duration))
        code, _, err = strikewave("wave", name, "--no-band")
        kept = Path("out/bar/case.toml").read_text()
        assert (code, "120 us" in kept) == {"100 us": (0, False), "120 us": (0, True), "140 us": (2, True)}[duration]
    assert '"one.toml"; give the case another name' in err
    assert strikewave("wave", "two.toml", "--no-band", "--force")[0] == 0
    assert "140 us" in Path("out/bar/case.toml").read_text()
    assert strikewave("wave", "out/bar/case.toml", "--no-band")[0] == 0  # the case of a result runs again


@pytest.mark.usefixtures("undrawn")
def test_two_records_of_one_name_do_not_share_a_folder_in_silence(strikewave):
    Path("monday").mkdir()
    Path("tuesday").mkdir()
    lines = [f"{k * 1e-5:.5f},{1000.0 if 100 <= k < 120 else 0.0}" for k in range(400)]
    Path("monday/shot.csv").write_text("time (s),accel (g)\n" + "\n".join(lines) + "\n")
    shutil.copy("monday/shot.csv", "tuesday/shot.csv")
    for command in ("record", "srs"):
        for place, code in (("monday", 0), ("tuesday", 2)):
            assert strikewave(command, f"{place}/shot.csv")[0] == code
        assert strikewave(command, "monday/shot.csv", "--filter", "10 kHz")[0] == 0
        assert len([one for one in os.listdir("out") if one.startswith(command)]) == 2  # what is filtered stands apart
