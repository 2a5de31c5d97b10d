"""Nothing of the user's is overwritten: what was put into a result folder, or changed in it, survives each command."""

from pathlib import Path

import pytest

from .each_command import CHEAP, write_inputs

pytestmark = pytest.mark.usefixtures("undrawn")


@pytest.mark.parametrize("force", [(), ("--force",)])
def test_a_result_that_holds_an_input_of_the_new_one_stays(strikewave, force):
    write_inputs(strikewave)
    assert strikewave("impact", *CHEAP["impact"], "--out", "blow")[0] == 0
    before = Path("blow/history.csv").read_bytes()
    for file in ("blow/history.csv", f"../{Path.cwd().name}/blow/history.csv"):
        words = (f"{file}#2", "pulse.csv", "--unit", "g", "--out", "blow", *force)
        code, _, err = strikewave("compare", *words)
        assert (code, Path("blow/history.csv").read_bytes()) == (2, before), err


@pytest.mark.parametrize(("name", "what"), [("impact", "added"), ("spec", "changed"), ("deck", "changed")])
def test_files_of_the_user_in_a_result_survive_each_command(strikewave, name, what):
    """Under a name that results have, and in a table of the result itself; forced or not."""
    write_inputs(strikewave)
    words = (name, *CHEAP[name], "--out", "here", "-q")
    assert strikewave(*words)[0] in (0, 3)
    mine = (
        Path("here/histories.csv")
        if what == "added"
        else next(x for x in sorted(Path("here").iterdir()) if x.suffix != ".toml")
    )
    mine.write_text("measured")
    for force in ((), ("--force",)):
        code, _, err = strikewave(*words, *force)
        assert (code, mine.read_text()) == (2, "measured"), err
        assert mine.name in err
    mine.unlink()
    assert strikewave(*words)[0] in (0, 3)  # the same result is written again
