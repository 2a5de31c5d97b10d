"""The engine of studies: keys, what is kept, resuming, workers that die, and equal numbers whoever runs them."""

import math
import sqlite3
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field

import numpy as np
import pyarrow.parquet as parquet
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave import load_case, run_case
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.cases.files import bundled_cases
from strikewave.studies.engine import evaluation
from strikewave.studies.engine import store as stores
from strikewave.studies.engine.case_evaluation import OF_FIRST, CaseEvaluation, numbers_of, read_kept
from strikewave.studies.engine.evaluation import Job, KeptHistory, RunOutcome, run_key
from strikewave.studies.engine.plan import (
    DrawVariation,
    drawn_rows,
    filled,
    grid,
    read_variable,
    sobol_sequence,
    varied,
)
from strikewave.studies.engine.pools import GivenPool, Loss, ProcessPool
from strikewave.studies.engine.runner import MOST_DEATHS, carry_out
from strikewave.studies.engine.store import APPLICATION, INDEX, RunStore
from strikewave.uncertainty.draws import tolerances_of

CASE = load_case("li-ma-2019")


@dataclass(frozen=True)
class Speed:
    """An evaluation whose number is known: the speed of the machine, which must not be 60 rad/s."""

    names: tuple[str, ...] = ("speed", "twice")

    def __call__(self, case):
        speed = case.machine.speed.si
        if speed == 60.0:
            raise InputError("machine.speed", speed, "another one")
        history = KeptHistory("ramp", "m", 2, 0.5, 0.1, speed * np.arange(3.0))
        return RunOutcome((speed, np.nan if speed == 50.0 else 2.0 * speed), (history,))


def speeds(*values):
    variable = read_variable(CASE, "machine.speed=" + ",".join(f"{value} rad/s" for value in values))
    return Job(varied(CASE, [variable], "test"), Speed()), grid([variable])


def run(store, *values, pool=None, job=None):
    made, rows = speeds(*values)
    with ProcessPool(1) if pool is None else pool as ready:
        found = carry_out(job or made, rows, store, ready)
    return found, store.table(("speed", "twice"), found.keys)


def test_rows_have_numbers_or_the_reason_why_not(tmp_path):
    with RunStore(tmp_path / "s") as store:
        found, (numbers, failures) = run(store, 50, 60, 70)
        assert found.reused == 0
        np.testing.assert_array_equal(numbers, [[50.0, np.nan], [np.nan, np.nan], [70.0, 140.0]])
        assert [bool(failure) for failure in failures] == [False, True, False]
        assert "machine.speed" in failures[1]


def test_what_is_finished_is_not_run_again_whatever_the_order(tmp_path):
    with RunStore(tmp_path / "s") as store:
        first, _ = run(store, 50, 60, 70)
    with RunStore(tmp_path / "s") as store:
        second, (numbers, failures) = run(store, 40, 50, 60, 70)
        assert second.reused == 3
        assert second.keys[1:] == first.keys
        assert numbers[:, 0][[0, 1, 3]].tolist() == [40.0, 50.0, 70.0]
        assert failures[2]
        assert len(store.known()) == 4


def test_equal_rows_are_run_once_and_all_have_their_numbers():
    job, _ = speeds(50)
    with RunStore(None) as store, ProcessPool(1) as pool:
        found = carry_out(job, [(70.0,), (80.0,), (70.0,), (60.0,), (70.0,)], store, pool)
        numbers, failures = store.table(("speed",), found.keys)
        assert len(store.known()) == 3
    assert numbers[:, 0].tolist()[:3] == [70.0, 80.0, 70.0]
    assert numbers[4, 0] == 70.0
    assert [bool(failure) for failure in failures] == [False, False, False, True, False]


def test_histories_come_back_as_they_were_from_index_and_files(tmp_path, monkeypatch):
    with RunStore(tmp_path / "s") as store:
        run(store, 50, 60, 70)
        waiting = dict(store.histories())
        store.write_chunk()
        run(store, 80)
        both = dict(store.histories())
    assert len(waiting) == 2
    assert len(both) == 3
    for key, before in waiting.items():
        assert both[key][:5] == before[:5] == ("ramp", "m", 2, 0.5, 0.1)
        np.testing.assert_array_equal(both[key].values, before.values)
    with RunStore(tmp_path / "s") as store:
        assert len(dict(store.histories())) == 3


def test_only_histories_of_the_runs_that_are_asked_for_are_handed_over(tmp_path):
    """A file that holds others too is parted; one that holds none of them is left."""
    (tmp_path / "result").mkdir()
    with RunStore(tmp_path / "s") as store:
        first, _ = run(store, 50, 70)
        store.write_chunk()
        second, _ = run(store, 80)
        store.write_chunk()
        assert store.hand_over(tmp_path / "result", [first.keys[1]]) == ["run-histories-1.parquet"]
        rows = parquet.read_table(tmp_path / "result" / "run-histories-1.parquet").to_pylist()
        assert [(row["key"], row["values"]) for row in rows] == [(first.keys[1], [0.0, 70.0, 140.0])]
        (tmp_path / "other").mkdir()
        assert store.hand_over(tmp_path / "other", second.keys) == ["run-histories-1.parquet"]
        held = parquet.read_table(tmp_path / "other" / "run-histories-1.parquet").to_pylist()
        assert [row["key"] for row in held] == second.keys
        assert len(dict(store.histories())) == 3


def test_runs_that_ended_for_want_of_memory_are_made_again_and_others_not(tmp_path):
    """The first session has little memory: 80 rad/s takes too much of it, and a process dies of 90."""
    made = []

    @dataclass(frozen=True)
    class Hungry(Speed):
        def __call__(self, case):
            made.append(case.machine.speed.si)
            if case.machine.speed.si == 80.0 and made.count(80.0) == 1:
                raise MemoryError
            return super().__call__(case)

        def __repr__(self):
            return "Speed"

    job = Job(speeds(50)[0].variation, Hungry())
    with RunStore(tmp_path / "s") as store:
        _, (_, failures) = run(store, 60, 70, 80, 90, pool=Mortal({90.0: 99}), job=job)
        assert [bool(failure) for failure in failures] == [True, False, True, True]
        assert failures[2] == "out of memory"
    with RunStore(tmp_path / "s") as store:
        found, (numbers, failures) = run(store, 60, 70, 80, 90, job=job)
    assert found.reused == 2
    assert [bool(failure) for failure in failures] == [True, False, False, False]
    assert numbers[1:, 0].tolist() == [70.0, 80.0, 90.0]
    assert (made.count(60.0), made.count(80.0)) == (1, 2)


def test_a_full_disk_is_named_with_what_is_free(tmp_path):
    """The index is held to the pages that it has, as a full disk would: SQLite says the same of both."""
    with RunStore(tmp_path / "s") as store:
        store._base.execute("PRAGMA max_page_count = 1")
        with pytest.raises(InputError, match=r"No space left on device: .* MB are free on the disk at"):
            run(store, *range(30, 130))


def test_full_chunks_are_written_by_themselves(tmp_path, monkeypatch):
    monkeypatch.setattr(stores, "CHUNK_BYTES", 48)
    with RunStore(tmp_path / "s") as store:
        run(store, 50, 70, 80, 90)
        assert len(store.chunks) > 0
        assert len(dict(store.histories())) == 4


def test_a_file_of_histories_whose_writing_was_not_finished_goes(tmp_path):
    with RunStore(tmp_path / "s") as store:
        run(store, 50)
        store.write_chunk()
        (known,) = store.chunks
    (tmp_path / "s" / "run-histories-7.parquet").write_bytes(known.read_bytes()[:50])
    (tmp_path / "s" / ".run-histories-8.parquet.partial").write_bytes(b"x")
    with RunStore(tmp_path / "s") as store:
        assert store.chunks == [known]
        assert len(list(store.histories())) == 1
    assert not list((tmp_path / "s").glob(".*"))


def test_histories_that_are_handed_over_stay_till_the_store_goes(tmp_path):
    """Who is stopped between both goes on with all of them; without one of them the store is refused."""
    (tmp_path / "result").mkdir()
    with RunStore(tmp_path / "s") as store:
        run(store, 50)
        evaluation = list(store.known())
        (name,) = store.hand_over(tmp_path / "result", evaluation)
    with RunStore(tmp_path / "s") as store:
        assert len(list(store.histories())) == 1
        (tmp_path / "s" / INDEX).rename(tmp_path / "index")
        store.remove()  # killed in the middle of it, after the index
    (tmp_path / "s").mkdir()
    (tmp_path / "s" / name).write_bytes((tmp_path / "result" / name).read_bytes())
    with RunStore(tmp_path / "s") as store:
        assert (store.known(), store.chunks) == (set(), [])
    (tmp_path / "index").rename(tmp_path / "s" / INDEX)
    with pytest.raises(InputError, match=f"{name} is gone"):
        RunStore(tmp_path / "s")


def test_a_transaction_that_fails_keeps_nothing_of_it(tmp_path):
    job, rows = speeds(50, 70)
    outcomes = job(rows)
    with RunStore(tmp_path / "s") as store:
        with pytest.raises(sqlite3.Error):
            store.keep(job.evaluation.names, [(b"a", outcomes[0]), (b"b", RunOutcome(("text", object())))])
        assert store.known() == set()
        store.keep(job.evaluation.names, [(b"a", outcomes[0])])
        store.keep(job.evaluation.names, [(b"a", outcomes[1])])
        assert store.table(("speed",), [b"a"])[0].tolist() == [[50.0]]


def test_a_second_study_on_the_same_folder_is_refused(tmp_path):
    with RunStore(tmp_path / "s"), pytest.raises(InputError, match="no other study"):
        RunStore(tmp_path / "s")


@pytest.mark.parametrize("damage", ["text", "other", "newer"])
def test_an_index_that_is_damaged_or_of_something_else_is_refused(tmp_path, damage):
    folder = tmp_path / "s"
    folder.mkdir()
    if damage == "text":
        (folder / INDEX).write_text("no database, but long enough to be one. " * 200)
    else:
        base = sqlite3.connect(folder / INDEX)
        base.execute("CREATE TABLE mine (x)")
        if damage == "newer":
            base.execute(f"PRAGMA application_id = {APPLICATION}")
            base.execute("PRAGMA user_version = 9")
        base.commit()
        base.close()
    before = (folder / INDEX).read_bytes()
    with pytest.raises(InputError, match="another program" if damage == "other" else "--fresh"):
        RunStore(folder)
    assert (folder / INDEX).read_bytes() == before
    if damage != "other":
        with RunStore(folder, fresh=True) as store:
            assert store.known() == set()


def test_pages_of_an_index_that_are_damaged_are_begun_anew(tmp_path):
    """Its head is whole, so that SQLite opens it; the pages of its tables are not."""
    with RunStore(tmp_path / "s") as store:
        run(store, 50, 70)
    index = tmp_path / "s" / INDEX
    content = index.read_bytes()
    index.write_bytes(content[:4096] + bytes(0xA5 for _ in content[4096:]))
    with pytest.raises(InputError, match="--fresh"), RunStore(tmp_path / "s") as store:
        store.known()
    with RunStore(tmp_path / "s", fresh=True) as store:
        run(store, 50, 70)
        assert len(store.known()) == 2


def test_a_folder_with_other_files_and_a_file_are_refused(tmp_path):
    (tmp_path / "mine.txt").write_text("x")
    with pytest.raises(InputError, match="other files"):
        RunStore(tmp_path)
    with pytest.raises(InputError, match="a file or a link"):
        RunStore(tmp_path / "mine.txt")


def test_fresh_removes_what_was_finished_and_remove_leaves_nothing(tmp_path):
    with RunStore(tmp_path / "s") as store:
        run(store, 50)
        store.write_chunk()
    with RunStore(tmp_path / "s", fresh=True) as store:
        assert store.known() == set()
        assert store.chunks == []
        store.remove()
    assert not (tmp_path / "s").exists()


def test_the_key_holds_case_evaluation_version_and_files(monkeypatch, tmp_path):
    one = CaseEvaluation("fast", ("cv",))
    key = run_key(CASE, one)
    assert key == run_key(load_case("li-ma-2019"), one)
    assert key != run_key(CASE, CaseEvaluation("fast", ("cv_later",)))
    assert key != run_key(CASE, CaseEvaluation("run", ("cv",)))
    assert key != run_key(load_case("li-ma-2019", ["contact.damping=lankarani-nikravesh"]), one)
    record = tmp_path / "force.csv"
    record.write_text("t [s],F [N]\n0,0\n1e-5,10\n2e-5,0\n")
    bar = load_case("li-ma-2019-fig13-bar", ["load.shape=file", f"load.file={record}"])
    with_file = run_key(bar, one)
    record.write_text("t [s],F [N]\n0,0\n1e-5,11\n2e-5,00\n")
    assert run_key(bar, one) != with_file
    for schema in ("SCHEMA", "ELEMENTS_SCHEMA"):
        with monkeypatch.context() as patched:
            evaluation.program_key.cache_clear()
            patched.setattr(evaluation, schema, 99)
            assert run_key(CASE, one) != key
    evaluation.program_key.cache_clear()
    assert run_key(CASE, one) == key
    monkeypatch.setattr(evaluation, "program_key", lambda: "another version")
    assert run_key(CASE, one) != key


@pytest.mark.parametrize("name", bundled_cases())
def test_every_quantity_of_every_built_in_case_tells_its_runs_apart(name):
    """One that is left out of the key would take the result of another run for its own."""
    case, one = load_case(name), CaseEvaluation("run", ("cv",))
    values = case.values()
    evaluation = {
        run_key(case.with_values({path: value.model_copy(update={"si": value.si + 1.0})}), one)
        for path, value in values.items()
    }
    assert len({*evaluation, run_key(case, one)}) == len(values) + 1


def test_what_is_drawn_of_single_strikers_tells_runs_apart():
    case, one = load_case("li-ma-2019-equal-blows"), CaseEvaluation("run", ("cv",))
    inputs = tolerances_of(case)
    middle = [value.value.si for value in inputs for _ in range(value.count)]
    rows = [
        tuple(middle),
        *(tuple(v + (1e-9 * abs(v) + 1e-12) * (k == j) for j, v in enumerate(middle)) for k in range(len(middle))),
    ]
    variation = DrawVariation(case, inputs)
    assert len({run_key(variation.case_of(row), one) for row in rows}) == len(rows)


@dataclass
class Mortal:
    """A pool whose process dies of some rows, always or so many times, and takes with it what is out."""

    deadly: dict
    width: int = 2
    out: list = field(default_factory=list)
    renewed: int = 0
    is_broken: bool = False

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None

    def loss(self, error):
        return Loss.BY_ANY if isinstance(error, BrokenProcessPool) else None

    def renew(self):
        self.renewed, self.is_broken, self.out = self.renewed + 1, False, []

    def submit(self, job, rows):
        future = Future()
        if self.is_broken:
            raise BrokenProcessPool
        struck = [row for row in rows if self.deadly.get(row[0], 0) > 0]
        if struck:
            self.deadly[struck[0][0]] -= 1
            self.is_broken = True
            future.set_exception(BrokenProcessPool())
        else:
            future.set_result(job(rows))
        return future


def test_a_run_that_its_process_dies_of_becomes_a_row_and_no_other_is_lost(tmp_path):
    values = tuple(range(30, 50))
    pool = Mortal({37.0: 99})
    with RunStore(tmp_path / "s") as store:
        _, (numbers, failures) = run(store, *values, pool=pool)
    died = [value for value, failure in zip(values, failures, strict=True) if failure]
    assert died == [37]
    assert f"ended {MOST_DEATHS} times" in failures[values.index(37)]
    alive = [value for value in values if value != 37]
    assert numbers[~np.isnan(numbers[:, 0]), 0].tolist() == alive
    assert pool.renewed >= MOST_DEATHS


def test_a_process_that_is_killed_loses_no_run(tmp_path):
    """By someone who needed its memory: the run is made again, and has its numbers."""
    values = tuple(range(30, 50))
    with RunStore(tmp_path / "s") as store:
        _, (numbers, failures) = run(store, *values, pool=Mortal({31.0: 1, 37.0: 2, 49.0: 2}))
    assert failures == [""] * len(values)
    assert numbers[:, 0].tolist() == list(values)


def test_a_given_executor_runs_it_and_a_broken_one_is_said(tmp_path):
    with ThreadPoolExecutor(2) as executor, RunStore(None) as store:
        _, (numbers, *_) = run(store, 50, 60, 70, pool=GivenPool(executor))
        assert numbers[:, 0].tolist()[::2] == [50.0, 70.0]

    class Broken(Mortal):
        def renew(self):
            GivenPool(ThreadPoolExecutor(1), 1).renew()
            raise StrikewaveError("ended")

    with RunStore(tmp_path / "s") as store:
        with pytest.raises(StrikewaveError, match="ended"):
            run(store, 40, 50, 70, pool=Broken({70.0: 9}, width=1))
        assert len(store.known()) == 2


def test_our_own_faults_are_no_rows():
    @dataclass(frozen=True)
    class Faulty(Speed):
        def __call__(self, case):
            raise KeyError("a fault of ours")

    job, rows = speeds(50)
    with RunStore(None) as store, pytest.raises(KeyError):
        carry_out(Job(job.variation, Faulty()), rows, store, ProcessPool(1))


@given(st.integers(2, 40), st.integers(1, 4))
def test_latin_hypercubes_meet_each_part_of_a_range_once(runs, seed):
    variable = read_variable(CASE, "machine.speed=400..900 rpm")
    spring = read_variable(CASE, "object.spring=20..80 kN/m:5 log")
    rows = np.array(filled([variable, spring], "latin-hypercube", runs, seed))
    low, high = variable.axis.values[0], variable.axis.values[-1]
    assert sorted((runs * (rows[:, 0] - low) / (high - low)).astype(int).tolist()) == list(range(runs))
    part = runs * np.log(rows[:, 1] / 20e3) / np.log(4.0)
    assert sorted(part.astype(int).tolist()) == list(range(runs))


def test_sobol_points_are_those_of_scipy_and_take_powers_of_two():
    points = sobol_sequence(3, 64, 5)
    counts = np.histogramdd(points[:, :2], bins=(8, 8), range=((0, 1), (0, 1)))[0]
    assert counts.max() == counts.min() == 1.0  # a (0, 6, 2)-net in base 2
    with pytest.raises(InputError, match="power of two"):
        sobol_sequence(3, 65, 5)


def test_more_draws_change_none_of_the_first():
    inputs = tolerances_of(CASE)
    assert drawn_rows(inputs, 6, 3)[:3] == drawn_rows(inputs, 3, 3)


@pytest.mark.parametrize(
    ("typed", "values"),
    [
        ("machine.speed=400..900rpm:3", ["400 rpm", "650 rpm", "900 rpm"]),
        ("machine.speed=900 rpm, 400rpm", ["400 rpm", "900 rpm"]),
        ("object.spring=10 kN/m..1000 kN/m:3 log", ["10 kN/m", "100 kN/m", "1000 kN/m"]),
        ("object.spring=10..1000 kN/m:3log", ["10 kN/m", "100 kN/m", "1000 kN/m"]),
        ("feed.blows=1..4", ["1.0", "2.0", "3.0", "4.0"]),
        ("contact.restitution=0.2,0.4", ["0.2", "0.4"]),
        ("contact.damping=hunt-crossley, exact", ["hunt-crossley", "exact"]),
    ],
)
def test_values_are_read_as_typed(typed, values):
    variable = read_variable(CASE, typed)
    assert [variable.shown(value) for value in variable.axis.values] == values


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        ("machine.sped=400..900 rpm", 'did you mean "machine.speed"'),
        ("machine.speed", "setting=values"),
        ("machine.speed=", "setting=values"),
        ("machine.speed=900..400 rpm", "end lies above"),
        ("machine.speed=4..9 mm", "speed of rotation"),
        ("machine.speed=1..2..3 rpm", "speed of rotation"),
        ("object.spring=-1..5 kN/m", "above 0"),
        ("object.damper=0..5 N s/m:3 log", "above zero"),
        ("machine.speed=1..2 rpm:1", "2 to"),
        ("feed.blows=1.5,2", "whole number"),
        ("contact.damping=hunt", "hunt-crossley"),
        ("contact.restitution=0.2 mm", "no unit"),
    ],
)
def test_what_cannot_be_varied_is_refused_in_one_line(typed, said):
    with pytest.raises(StrikewaveError, match=said.replace("(", "\\(")) as refused:
        read_variable(CASE, typed)
    assert "\n" not in str(refused.value)


@given(st.text(max_size=30))
def test_no_text_ends_the_reading_otherwise(text):
    try:
        variable = read_variable(CASE, f"machine.speed={text}")
    except StrikewaveError:
        return
    assert np.isfinite(variable.axis.values).all()


def test_unknown_numbers_and_histories_are_refused():
    for words, said in (
        (["first.rigid_pek"], "rigid_peak"),
        (["pulses"], "blows has peak"),
        (["first.sensor_peak"], "sensor"),
    ):
        with pytest.raises(InputError, match=said):
            read_kept(CASE, "fast" if "sensor" not in words[0] else "run", words)
    bar = load_case("li-ma-2019-fig13-bar")
    with pytest.raises(InputError, match="only a machine"):
        read_kept(bar, "wave", ["blows"])


@pytest.mark.parametrize("given", ["400:900 rpm", "400rpm:900rpm", "400:50:900 rpm"])
def test_a_range_as_other_tools_write_it_is_refused_with_the_one_that_is_meant(given):
    with pytest.raises(InputError, match=r'such as "machine\.speed=400(rpm)?\.\.900 ?rpm:11"'):
        read_variable(CASE, f"machine.speed={given}")


@pytest.mark.parametrize(("analysis", "blows"), [("run", 3), ("fast", 3), ("impact", 1)])
def test_every_number_that_may_be_kept_is_there_where_the_blow_struck(analysis, blows):
    """Sensors and layers, which this case has not, are left out; three blows have each number of later ones."""
    case = load_case("li-ma-2019", [f"feed.blows={blows}"])
    others = ("first.sensor_peak", "first.sensor_width", "first.total_peak", "first.wave_peak")
    names = [name for name in numbers_of(case, analysis) if name not in others]
    kept = read_kept(case, analysis, names)
    outcome = dict(zip(kept.names, kept(case).numbers, strict=True))
    assert [name for name in names if outcome[name] is None or not math.isfinite(outcome[name])] == []
    if analysis == "impact":
        return
    first = next(blow for blow in run_case(case).blows if blow.kind != "missed")
    for name in OF_FIRST:
        if f"first.{name}" in names:  # the fast run holds its object as one body: its own tests say how near it is
            near = pytest.approx(getattr(first, name), rel=1e-12 if analysis == "run" else 0.05)
            assert outcome[f"first.{name}"] == near
