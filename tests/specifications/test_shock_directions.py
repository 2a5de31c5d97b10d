"""Shocks counted by direction, on campaigns small enough to be counted by hand."""

import math

import pytest

from strikewave.base.errors import InputError
from strikewave.specifications.judged_records import (
    CountedShock,
    check_directions,
    cross_axis_fits,
    direction_clauses,
    direction_fits,
    read_direction,
)
from strikewave.specifications.reading import ShockCount


def shocks(direction, verdicts, file="a.csv", channel=1, name=""):
    return [CountedShock(file, channel, name, direction, verdict) for verdict in verdicts]


PASSED, FAILED, OPEN = ["pass"], ["fail"], ["cannot-tell"]
THREE = ShockCount(3.0, math.inf, 1, "quoted")


@pytest.mark.parametrize(
    ("some", "count", "value", "verdict", "reason"),
    [
        (shocks("+x", PASSED * 3 + FAILED), THREE, 3.0, "pass", ""),
        (shocks("+x", PASSED * 2 + FAILED), THREE, 2.0, "fail", "2 of 3 shocks pass; 3 are asked for"),
        (shocks("+x", PASSED * 2 + OPEN), THREE, 2.0, "cannot-tell", "2 of 3 shocks pass; 3 are asked for"),
        (shocks("+x", PASSED + OPEN), THREE, 1.0, "fail", "1 of 2 shocks pass; 3 are asked for"),
        (shocks("+x", PASSED * 5), ShockCount(3.0, 4.0, 1, "quoted"), 5.0, "fail", "5 of 5 shocks pass; 3 to 4 are"),
        (
            shocks("+x", PASSED * 2) + shocks("", PASSED, "b.csv"),
            THREE,
            2.0,
            "cannot-tell",
            "2 of 2 shocks pass, and b.csv has no direction; 3 are asked for",
        ),
        # two channels of one file recorded the same blows: the one with fewer that pass counts
        (
            shocks("+x", PASSED * 3) + shocks("+x", PASSED * 2 + FAILED, channel=2),
            THREE,
            2.0,
            "fail",
            "2 of 3 shocks pass; 3 are asked for",
        ),
        # of several files they add up
        (shocks("+x", PASSED * 2) + shocks("+x", PASSED, "b.csv"), THREE, 3.0, "pass", ""),
    ],
)
def test_shocks_of_a_direction_are_counted(some, count, value, verdict, reason):
    clause = direction_clauses(some, ["+x"], count)[0]
    assert (clause.clause, clause.value, clause.verdict, clause.reason) == ("shocks in +x", value, verdict, reason)


def test_directions_that_lack_fail_unless_shocks_have_none():
    three = ShockCount(1.0, math.inf, 3, "quoted")
    some = shocks("-y", PASSED) + shocks("+x", PASSED)
    found = direction_clauses(some, ["-y", "+x"], three)
    assert [clause.clause for clause in found] == ["shocks in +x", "shocks in -y", "directions"]
    assert (found[-1].value, found[-1].verdict, found[-1].reason) == (2.0, "fail", "not stated: -x, +y, +z, -z")
    loose = direction_clauses(some + shocks("", FAILED, "x/l.csv", name="acc"), ["-y", "+x"], three)
    assert [clause.verdict for clause in loose[-2:]] == ["not-judged", "cannot-tell"]
    assert (loose[-2].low, loose[-2].high) == (0.0, 0.0)
    assert loose[-2].reason.startswith("l.csv, acc has no direction")
    several = some + [one for name in "abcde" for one in shocks("", FAILED, f"{name}.csv")]
    assert " have no direction" in direction_clauses(several, ["+x"], three)[-2].reason
    assert direction_clauses(some, [], three)[0].verdict == "not-judged"
    assert direction_clauses(some, ["+x", "-y"], ShockCount(1.0, math.inf, 2, "quoted"))[-1].verdict == "pass"


@pytest.mark.parametrize("word", ["x", "=+x", "+w", "a=+w"])
def test_what_is_no_direction_is_refused(word):
    with pytest.raises(InputError, match="a direction of"):
        read_direction(word)


def test_a_place_means_files_channels_or_both():
    places = ["", "up*", "up*#2", "up*#acc", "down*", "#2", "#3", "down*#2", "a/up.csv"]
    fits = [direction_fits(place, "a/up.csv", {"acc", "2"}) for place in places]
    assert fits == [True, True, True, True, False, True, False, False, True]
    assert direction_fits("up.csv", "a/up.csv: measurement 2", {"1"})
    files = [("a/up.csv", [{"acc", "2"}]), ("empty.csv", [])]
    check_directions([read_direction(word) for word in ("+x", "up*#2=+x", "empty.csv=+y")], files)
    for word, words in (("up*#acb=+x", "a channel of these files; did you mean"), ("uq.csv=+x", "a pattern that fits")):
        with pytest.raises(InputError, match=words):
            check_directions([read_direction(word)], files)


def test_a_file_is_meant_by_its_name_its_path_or_a_pattern_of_either():
    for place, path, fits in (
        ("up[1].csv", "up[1].csv", True),  # a name that is no pattern of itself
        ("a/*.csv", "a/up.csv", True),
        ("a/*.csv", "b/up.csv", False),
        ("u*", "a/up.csv", True),
        ("*", "a/up.csv: measurement 2", True),
        ("up.csv: measurement 3", "a/up.csv: measurement 2", False),
    ):
        assert direction_fits(place, path, {"1"}) == fits
        assert cross_axis_fits(f"{place}#1", path, {"1"}) == fits
    assert not cross_axis_fits("a/up.csv", "a/up.csv", {"1"})
    assert not direction_fits("down*#1", "up.csv", {"1"})
    assert not direction_fits("up*#2", "up.csv", {"1"})


def test_a_misspelt_file_or_channel_is_told_the_nearest():
    files = [("a/up.csv", [{"acc", "2"}, {"third", "3"}]), ("a/down.csv", [{"acc", "1"}])]
    for word, words in (
        ("up*#acb=+x", 'did you mean "acc"'),
        ("ub.csv#2=+x", 'did you mean "up.csv"'),
        ("ub.csv=+x", 'did you mean "up.csv"'),
        ("ub.csv#a-long-channel=+x", 'did you mean "up.csv"'),
    ):
        with pytest.raises(InputError, match=words):
            check_directions([read_direction(word)], files)
    check_directions([read_direction("up.csv#third=+x"), read_direction("#1=-x")], files)


def test_three_files_without_a_direction_are_named():
    some = shocks("+x", PASSED) + [one for name in "abcde" for one in shocks("", FAILED, f"{name}.csv")]
    reason = direction_clauses(some, ["+x"], THREE)[-2].reason
    assert reason.startswith("a.csv; b.csv; c.csv")
    assert "d.csv" not in reason
