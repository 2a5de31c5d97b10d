"""Every machine case is run, its recorder's file read back: what the recorder was given, and no fault where none is.

The reference is the acceleration of each blow at the step of the solver's own windows, measured here by its definition:
the largest value over the zero before first touch, the time above a tenth of it, and the integral between its feet at 2 %.
"""

import numpy as np
import pytest

import strikewave
from strikewave.cases.case import load_case
from strikewave.cases.files import bundled_cases
from strikewave.records.record import OF_BODY
from strikewave.reporting.table_files import write_histories

MACHINES = [name for name in bundled_cases() if load_case(name).machine is not None]
QUICK = {"li-ma-2019": ["feed.blows=3"], "jesd22-b111-b": [], "machete-13-teeth": []}
"""Cases of `make test`, with what is changed of them."""
CLOSE = 0.01
"""A recorder that takes 20 samples a pulse is at most half a sample off its peak, 0.3 %, and off each side of a width."""


def crossing(time, values, top, level, side):
    """Where a pulse falls below a level, on a straight line between two samples."""
    k = top
    while values[k] > level:
        k += side
    return time[k] + (level - values[k]) / (values[k - side] - values[k]) * (time[k - side] - time[k])


def given(solution):
    """Peak, width and velocity change of what the recorder was given, a row a blow."""
    time, rows = solution.data["pulse_time"].values, solution.data["pulse_acceleration"].values
    found = []
    for row, blow in zip(rows, solution.blows, strict=True):
        known = np.isfinite(row)
        t, a = time[known], row[known]
        a = a - a[t < 0.0][-1]
        top = int(np.argmax(a))
        low, foot = ([crossing(t, a, top, share * a[top], side) for side in (-1, 1)] for share in (0.1, 0.02))
        inside = (t >= foot[0]) & (t <= foot[1])
        found.append((a[top], low[1] - low[0], np.trapezoid(a[inside], t[inside]), blow.time))
    return np.array(found)


WRITTEN = {}
"""Texts of the files of runs, by the identity of their solutions."""


def read_back(solution, folder, broken=lambda text: text):
    """What `record` reads of the file that the run writes of its recorder."""
    folder.mkdir(exist_ok=True)
    file = folder / "histories-record.csv"
    if id(solution) not in WRITTEN:
        write_histories(solution, folder, "csv")
        WRITTEN[id(solution)] = file.read_text("utf-8")
    file.write_text(broken(WRITTEN[id(solution)]), "utf-8")
    return strikewave.record(str(file))


def misses(solution, result):
    """What of a read record is not as it was given, in words."""
    [file] = result.readings
    [reading] = file.channels
    truth = given(solution)
    if len(reading.pulses) != len(truth):
        return [f"{len(reading.pulses)} blows of {len(truth)}"]
    wrong = [] if file.status == "good" else [f"{file.status}: {file.reasons}"]
    read = np.array([(pulse.peak, pulse.width, pulse.velocity_change) for pulse in reading.pulses])
    blows = np.array([(blow.rigid_peak, blow.width, blow.velocity_change) for blow in solution.blows])
    off_by = (read / truth[:, :3] - 1.0).T
    wrong += [
        f"the table of blows: {row}" for row in np.argwhere(~(np.abs(blows / truth[:, :3] - 1.0) < CLOSE)).tolist()
    ]
    for name, whole, off in zip(("peak", "width", "velocity change"), truth[:, :3].T, off_by, strict=True):
        wrong += [f"{name} of blow {k + 1} by {one:+.2%}" for k, one in enumerate(off) if not abs(one) < CLOSE]
        stated = [one.statistics.get(name.replace(" ", "_")) for one in result.campaigns]
        wrong += [f"mean {name}" for one in stated if one is None or not abs(one.mean / np.mean(whole) - 1.0) < CLOSE]
    late = [pulse.time - blow for pulse, blow in zip(reading.pulses, truth[:, 3], strict=True)]
    wrong += [f"time of blow {k + 1}" for k, one in enumerate(late) if not 0.0 < one < truth[k, 1]]
    return wrong


@pytest.fixture(scope="module")
def run():
    """Cases that were run, each once."""
    known = {}

    def one(name, changes=()):
        key = name, tuple(changes)
        if key not in known:
            known[key] = strikewave.run_case(load_case(name, list(changes)))
        return known[key]

    return one


@pytest.mark.parametrize(
    "name", [*QUICK, *(pytest.param(n, marks=pytest.mark.verify) for n in MACHINES if n not in QUICK)]
)
def test_the_recorder_of_a_machine_reads_back_as_it_was_given(name, run, tmp_path):
    solution = run(name, QUICK.get(name, ()))
    assert misses(solution, read_back(solution, tmp_path)) == []


def changed(values):
    """A break of the file: its samples changed, from an array to an array."""

    def broken(text):
        head, *lines = text.strip().split("\n")
        table = np.array([line.split(",") for line in lines], dtype=float)
        time, acceleration = values(*table.T)
        rows = np.char.add(np.char.add(np.char.mod("%.9g", time), ","), np.char.mod("%.9g", acceleration))
        return "\n".join([head, *rows.tolist()]) + "\n"

    return broken


BREAKS = {
    "another gain": lambda t, a: (t, 1.02 * a),
    "another clock": lambda t, a: (1.02 * t, a),
    "a blow cut out": lambda t, a: (t, np.where((t > 0.06) & (t < 0.065), 0.0, a)),
    "the end cut off": lambda t, a: (t[t < 0.0422], a[t < 0.0422]),
    "a zero that shifts": lambda t, a: (t, a + 0.05 * np.max(a) * (t > 0.0624)),
    "clipped": lambda t, a: (t, np.minimum(a, 0.95 * np.max(a))),
    "another sign": lambda t, a: (t, -a),
}


@pytest.mark.parametrize("link", BREAKS)
def test_a_broken_link_is_seen(link, run, tmp_path):
    solution = run("li-ma-2019", QUICK["li-ma-2019"])
    assert misses(solution, read_back(solution, tmp_path, changed(BREAKS[link])))


def test_the_reader_knows_the_names_that_a_run_gives_the_motion_of_a_body(run):
    names = {name for name in run("li-ma-2019", QUICK["li-ma-2019"]).data.variables if name.endswith("acceleration")}
    assert names == set(OF_BODY)


def test_the_same_samples_under_another_name_may_be_those_of_a_sensor_that_rings(run, tmp_path):
    """Whose ringing it is one record does not show: 1.3 swings in a blow are of its length."""
    solution = run("li-ma-2019", QUICK["li-ma-2019"])
    named = read_back(solution, tmp_path, lambda text: text.replace("record_acceleration", "sensor"))
    assert named.readings[0].status == "suspect"
    codes = {finding.code: finding.severity for finding in named.readings[0].all_findings}
    assert codes["ringing"] == "suspect"
    assert "zero-shift" not in codes  # the object is drawn back and comes to rest: that is no zero


@pytest.mark.parametrize(("planted", "severity"), [(0.0, "info"), (0.3, "warning")])
def test_what_rings_beside_the_run_of_its_machine_is_its_motion_unless_something_else_rings(
    planted, severity, run, tmp_path
):
    """The frame swings at 6.6 kHz; a mount of 12 kHz by a third of the peak is not the machine."""
    solution = run("li-ma-2019", QUICK["li-ma-2019"])
    blows = [blow.time for blow in solution.blows]

    def with_mount(t, a):
        since = t[:, None] - np.array(blows)
        swing = np.exp(-np.maximum(since, 0.0) / 1e-3) * np.sin(2.0 * np.pi * 12e3 * since)
        return t, a + planted * np.max(a) * np.sum(np.where(since > 0.0, swing, 0.0), axis=1)

    named = changed(with_mount)
    read_back(solution, tmp_path, lambda text: named(text).replace("record_acceleration", "sensor"))
    notices = strikewave.compare(solution, str(tmp_path / "histories-record.csv")).notices
    assert [notice.severity for notice in notices if notice.code == "ringing"] == [severity]


@pytest.mark.verify
@pytest.mark.parametrize("share", [-0.05, 0.05, 0.1])
@pytest.mark.parametrize("blow", [0, 5])
def test_a_zero_that_shifts_in_the_motion_of_a_machine_is_found(share, blow, run, tmp_path):
    """And one of a tenth, which hides the blows, is bad."""
    solution = run("li-ma-2019")
    peak, time = solution.blows[5].rigid_peak, solution.blows[blow].time + 1e-4
    [file] = read_back(solution, tmp_path, changed(lambda t, a: (t, a + share * peak * (t > time)))).readings
    assert file.status != "good"
    assert {"zero-shift", "no-pulse"} & {finding.code for finding in file.all_findings if finding.severity != "good"}
