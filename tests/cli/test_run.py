"""``strikewave run`` takes any case or set-up: its tables say which analysis."""

import json

import pytest

from strikewave.analyses.hopkinson.build import example_setup

BAR = "li-ma-2019-fig13-bar"


def test_a_layered_bar_gives_what_wave_gives(strikewave):
    code, out, _ = strikewave("run", "--no-band", BAR, "--json")
    other, same, _ = strikewave("wave", "--no-band", BAR, "--json")
    assert code == other
    assert json.loads(out) == json.loads(same)


def test_a_set_up_goes_the_way_of_hopkinson(strikewave, tmp_path):
    """Its records are not there: both commands say so in the same words."""
    (tmp_path / "shot.toml").write_text(example_setup())
    code, out, err = strikewave("run", "--no-band", "shot.toml", "--json")
    assert (code, out) == (2, "")
    assert err == strikewave("hopkinson", "shot.toml", "--json")[2]
    code, _, err = strikewave("run", "--no-band", "shot.toml", "--animate")
    assert code == 2
    assert "--animate" in err
    assert "no motion" in err


@pytest.mark.parametrize("name", ["li-ma-2018", "nothing.toml"])
def test_what_is_no_case_is_named(strikewave, name):
    code, out, err = strikewave("run", "--no-band", name)
    assert (code, out) == (2, "")
    assert name in err
