"""Long tables: a column names the channel, or the measurement, of each line; every order and way of writing them."""

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.records import Channel
from strikewave.records.calibration import even
from strikewave.records.readers import Options, read_measurements, read_record

SIZE, STEP = 40, 2e-5
TIME = np.round(STEP * np.arange(SIZE), 9)
FIRST = np.round(100.0 * np.sin(0.3 * np.arange(SIZE)), 3)
SECOND = np.round(50.0 * np.cos(0.2 * np.arange(SIZE)), 3)


def lines(order, cells):
    """Write lines of two channels, interleaved or one after the other; ``cells`` lays out time, name, value."""
    both = [(k, name, value) for name, values in (("A", FIRST), ("B", SECOND)) for k, value in enumerate(values)]
    both.sort(key=lambda one: one[0] if order == "interleaved" else 0)
    return "".join(cells(TIME[k], name, value) + "\n" for k, name, value in both)


@pytest.fixture
def read(tmp_path):
    def call(content, options=Options()):  # noqa: B008
        (tmp_path / "long.csv").write_text(content)
        return read_record(tmp_path / "long.csv", options)

    return call


def given(record):
    return [(channel.name, channel.unit) for channel in record.channels]


def same(record, step=STEP):
    assert [channel.values.tolist() for channel in record.channels] == [FIRST.tolist(), SECOND.tolist()]
    assert [channel.step for channel in record.channels] == pytest.approx([step, step], rel=1e-9)
    assert [channel.start for channel in record.channels] == [0.0, 0.0]


NUMBER = {"A": 3, "B": 7}
LAYOUTS = {
    "in the middle": ("Time (s),Channel,Value (g)\n", lambda t, n, v: f"{t:.5f},{n},{v}", ("A", "B")),
    "first": ("Kanal;Zeit [s];Wert [g]\n", lambda t, n, v: f"{n};{t:.5f};{v}".replace(".", ","), ("A", "B")),
    "last": ("time [s]\tacc [g]\tsensor\n", lambda t, n, v: f"{t:.5f}\t{v}\t{n}", ("A", "B")),
    "another word": ("time [s],acc [g],where\n", lambda t, n, v: f"{t:.5f},{v},{n}", ("A", "B")),
    "numbers": ("time [s],channel,acc [g]\n", lambda t, n, v: f"{t:.5f},{NUMBER[n]},{v}", ("channel 3", "channel 7")),
    "numbers, id": ("id,time [s],acc [g]\n", lambda t, n, v: f"{NUMBER[n]},{t:.5f},{v}", ("id 3", "id 7")),
}


@pytest.mark.parametrize("order", ["interleaved", "sorted"])
@pytest.mark.parametrize("layout", LAYOUTS, ids=list(LAYOUTS))
def test_each_channel_of_a_long_table_has_its_own_samples(read, layout, order):
    head, cells, names = LAYOUTS[layout]
    record = read(head + lines(order, cells))
    same(record)
    assert given(record) == [(name, "g") for name in names]
    assert "long-table" in [finding.code for finding in record.findings]


@pytest.mark.parametrize("order", ["interleaved", "sorted"])
def test_a_long_table_without_a_head_is_known_by_its_times(read, order):
    same(read(lines(order, lambda t, n, v: f"{t:.5f},{NUMBER[n]},{v}")))
    same(read(lines(order, lambda t, n, v: f"{t:.5f},{n},{v}")))


def test_channels_that_take_turns_at_rising_times_are_mark_responses(read):
    content = lines("interleaved", lambda t, n, v: f"{t + (n == 'B') * 1e-5:.5f},{n},{v}")
    record = read("time [s],channel,acc [g]\n" + content)
    assert [channel.start for channel in record.channels] == [0.0, 1e-5]
    assert record.channels[0].values.tolist() == FIRST.tolist()


def test_a_column_of_units_gives_each_channel_its_own(read):
    unit = {"A": "g", "B": "N"}
    record = read("time [s],channel,value,unit\n" + lines("interleaved", lambda t, n, v: f"{t:.5f},{n},{v},{unit[n]}"))
    assert given(record) == [("A", "g"), ("B", "N")]


def test_lines_that_name_no_channel_are_left_out_and_reported(read):
    content = lines("interleaved", lambda t, n, v: f"{t:.5f},{n if t % 1e-4 > 1e-9 else ''},{v}")
    record = read("time [s],channel,acc [g]\n" + content)
    assert [channel.name for channel in record.channels] == ["A", "B"]
    assert [(f.code, f.severity) for f in record.findings][:1] == [("label-missing", "suspect")]


def test_two_units_for_one_channel_are_refused(read):
    content = lines("interleaved", lambda t, n, v: f"{t:.5f},{n},{v},{'g' if t < 4e-4 else 'N'}")
    with pytest.raises(InputError, match=r"one unit for all lines of A.*g, N"):
        read("time [s],channel,value,unit\n" + content)


def test_several_values_of_each_channel_keep_their_names(read):
    record = read("time [s],channel,raw [V],acc [g]\n" + lines("sorted", lambda t, n, v: f"{t:.5f},{n},0.5,{v}"))
    assert given(record) == [("A raw", "V"), ("A acc", "g"), ("B raw", "V"), ("B acc", "g")]


def test_a_column_of_runs_makes_measurements(tmp_path):
    content = lines("sorted", lambda t, n, v: f"{NUMBER[n]},{t:.5f},{v}")
    (tmp_path / "runs.csv").write_text("run,time [s],acc [g]\n" + content)
    records = read_measurements(tmp_path / "runs.csv")
    assert [given(record) for record in records] == [[("acc", "g")]] * 2
    assert [record.channels[0].values.tolist() for record in records] == [FIRST.tolist(), SECOND.tolist()]


def test_runs_of_several_channels_are_mark_responses_in_both(tmp_path):
    content = "".join(lines("interleaved", lambda t, n, v, run=run: f"{run},{n},{t:.5f},{v + run}") for run in (1, 2))
    (tmp_path / "runs.csv").write_text("shot,channel,time [s],acc [g]\n" + content)
    records = read_measurements(tmp_path / "runs.csv")
    assert [given(record) for record in records] == [[("A", "g"), ("B", "g")]] * 2
    assert records[1].channels[1].values == pytest.approx(SECOND + 2)


def test_a_channel_of_a_long_table_is_chosen_by_its_name_and_a_rate_overrules_its_time(read):
    content = "time [s],channel,acc [g]\n" + lines("interleaved", lambda t, n, v: f"{t:.5f},{n},{v}")
    record = read(content, Options(channels=("B",), rate=1e5))
    assert record.channels[1].values.tolist() == SECOND.tolist()
    assert record.channels[0].values.strides == (0,)
    assert [(channel.step, channel.stamps) for channel in record.channels] == [(1e-5, None)] * 2
    with pytest.raises(InputError, match="--channel"):
        read(content, Options(channels=("C",)))


def test_without_time_a_heading_tells_the_channels(read):
    record = read("channel,acc [g]\n" + lines("sorted", lambda t, n, v: f"{n},{v}"), Options(rate=1.0 / STEP))
    same(record)


def test_many_blocks_of_a_large_long_table_are_mark_responses(tmp_path, monkeypatch):
    monkeypatch.setattr("strikewave.records.readers.columns.BLOCK", 2000)
    head, cells, _ = LAYOUTS["in the middle"]
    (tmp_path / "long.csv").write_text(head + lines("sorted", cells))
    same(read_record(tmp_path / "long.csv"))


@pytest.mark.parametrize(
    "word", [lambda k: "over" if k % 7 == 0 else "ok", lambda k: "", lambda k: "start" if k == 0 else "run"]
)
def test_a_column_of_remarks_names_no_channels(read, word):
    record = read(
        "time [s],acc [g],state\n"
        + "".join(f"{t:.5f},{v},{word(k)}\n" for k, (t, v) in enumerate(zip(TIME, FIRST, strict=True)))
    )
    assert [(c.name, c.values.tolist()) for c in record.channels] == [("acc", FIRST.tolist())]


def test_a_digital_trigger_is_a_channel_of_its_own(read):
    rows = "".join(f"{t:.5f},{int(k > 20)},{v}\n" for k, (t, v) in enumerate(zip(TIME, FIRST, strict=True)))
    assert [channel.name for channel in read("time [s],signal,acc [g]\n" + rows).channels] == ["signal", "acc"]
    assert len(read(rows).channels) == 2


def test_a_trigger_beside_stamps_that_stand_twice_in_a_part_is_a_channel(read):
    """Only the lines of 1 rise in time: those of 0 are of one recorder with a coarse clock."""
    rows = "".join(f"{(k // 2 if k < 60 else k - 30) * 1e-5:.5f},{int(k >= 60)},{k}.5\n" for k in range(100))
    assert [channel.name for channel in read("time [s],signal,acc [g]\n" + rows).channels] == ["signal", "acc"]


def test_more_names_than_a_recorder_has_channels_are_refused(read):
    rows = "".join(f"{1e-5 * k:.5f},c{k % 80},{k}\n" for k in range(1600))
    with pytest.raises(InputError, match=r"2 to 64 channels.*80 names"):
        read("time [s],channel,acc [g]\n" + rows)


def test_every_instant_twice_in_one_column_is_bad():
    stamps = np.repeat(np.round(TIME, 5), 2)
    channel, findings = even(Channel("value", np.arange(2.0 * SIZE), STEP / 2.0, stamps=stamps))
    assert [(f.code, f.severity) for f in findings] == [("time-twice", "bad")]
    assert channel.values.size == SIZE


def test_rounded_stamps_that_stand_twice_are_no_second_channel():
    stamps = np.round(5e-6 * np.arange(4000), 5)
    _, findings = even(Channel("value", np.arange(4000.0), 5e-6, stamps=stamps))
    assert findings == []


def write_workbook(path, rows):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for row in rows:
        book.active.append(row)
    book.save(path)
    return path


def rows_of(order, name=lambda n: n):
    return [
        [float(t), name(n), float(v)]
        for t, n, v in (line.split(",") for line in lines(order, lambda t, n, v: f"{t:.5f},{n},{v}").splitlines())
    ]


@pytest.mark.parametrize("order", ["interleaved", "sorted"])
@pytest.mark.parametrize("name", [str, NUMBER.get], ids=["words", "numbers"])
def test_a_long_table_in_a_workbook_or_parquet_is_read_channel_by_channel(tmp_path, order, name):
    import pyarrow as pa
    import pyarrow.parquet as pq

    rows, head = rows_of(order, name), ["time [s]", "channel", "acc [g]"]
    same(read_record(write_workbook(tmp_path / "a.xlsx", [head, *rows])))
    columns = {key: list(column) for key, column in zip(head, zip(*rows, strict=True), strict=True)}
    pq.write_table(pa.table(columns), tmp_path / "a.parquet")
    same(read_record(tmp_path / "a.parquet"))


def test_a_workbook_whose_first_column_names_the_channel(tmp_path):
    rows = [[n, t, v] for t, n, v in rows_of("sorted")]
    same(read_record(write_workbook(tmp_path / "a.xlsx", [["channel", "time [s]", "acc [g]"], *rows])))


def test_names_of_waveforms_of_a_workbook_give_their_units(tmp_path):
    head = [["waveform", "board [g]", "frame [N]"], ["delta t", STEP, STEP], ["time", "Y[0]", "Y[1]"]]
    rows = [[None, float(a), float(b)] for a, b in zip(FIRST, SECOND, strict=True)]
    assert given(read_record(write_workbook(tmp_path / "a.xlsx", [*head, *rows]))) == [("board", "g"), ("frame", "N")]


def test_rows_of_settings_of_a_workbook_are_no_samples(tmp_path):
    head = [
        ["Name", "board", "frame"],
        ["Unit", "g", "N"],
        ["t0", "05/01/2026 10:45:47.003", "05/01/2026 10:45:47.000"],
    ]
    head += [["delta t", STEP, 2.0 * STEP], ["Offset", 0, 0]]
    rows = [[None, float(a), float(b)] for a, b in zip(FIRST, SECOND, strict=True)]
    record = read_record(write_workbook(tmp_path / "a.xlsx", [*head, *rows]))
    assert given(record) == [("board", "g"), ("frame", "N")]
    assert [channel.values.tolist() for channel in record.channels] == [FIRST.tolist(), SECOND.tolist()]
    assert [(channel.step, channel.start) for channel in record.channels] == [(STEP, 0.003), (2.0 * STEP, 0.0)]
