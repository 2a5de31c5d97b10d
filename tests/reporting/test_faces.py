"""A number that is declared stands on every face: one line, and its value, unit and label are the same everywhere."""

import dataclasses
import re
from pathlib import Path
from typing import ClassVar

import pytest

import strikewave
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, Quantity
from strikewave.base.result import Band, Source
from strikewave.reporting import faces, terminal
from strikewave.reporting.chapters import plain_page
from strikewave.reporting.columns import Column, csv_table
from strikewave.reporting.numbers import ShownUnits, showing
from strikewave.reporting.parts import Tag
from strikewave.reporting.shown_result import ShownResult, shown_table
from strikewave.reporting.table_files import _sheets

PEAK = Quantity("m/s^2", "g", "planted peak", 1)


@declare.dataclass
class Reading:
    """What a sensor shows."""

    peak: float = declare.number(PEAK, "planted", column=MAIN, band="peak", headline="sensor {name}")
    clipped: bool = declare.word("whether it was cut", column=MAIN)


@declare.dataclass
class Row:
    """A row."""

    name: str = declare.word("name of the row", label="place", column=KEY)
    peak: float = declare.number(PEAK, "planted", column=MAIN, band="peak", headline="peak at {name}")
    length: float = declare.number(Quantity("m", "mm"), "a length", column=MORE + 1)
    seen: dict[str, Reading] = declare.named(Reading, "sensors by name")


@declare.dataclass
class Planted(ShownResult):
    """A result with a number that faces have to show."""

    command: ClassVar[str] = "run"
    main_rows: ClassVar[str] = "places"
    drawing: ClassVar[str] = ""

    places: tuple[Row, ...] = declare.rows(Row, "the places", band="at.{name}", headline="first")
    planted: float = declare.number(PEAK, "planted", headline="planted number", band="planted")

    @property
    def title(self):
        return "Planted"

    @property
    def source(self):
        return Source("command", "planted", "")


G = 9.80665


@pytest.fixture
def result():
    rows = (Row("a", 1000.0 * G, 0.002, {"s": Reading(500.0 * G, True)}), Row("b", 2000.0 * G, 0.004, {}))
    return Planted(rows, 1234.4 * G)


def test_document_and_units(result):
    document = result.document()
    assert document["planted"] == 1234.4 * G
    assert document["places"][0] == {
        "name": "a", "peak": 1000.0 * G, "length": 0.002, "seen": {"s": {"peak": 500.0 * G, "clipped": True}},
    }  # fmt: skip
    assert document["units"] == {"peak": "m/s^2", "length": "m", "planted": "m/s^2"}


def test_key_numbers_are_those_of_the_first_row(result):
    assert result.highlights() == [("peak at a", "1000 g"), ("planted number", "1234 g")]
    banded = dataclasses.replace(result, band={"at.a.peak": Band(900.0 * G, 1200.0 * G, 0.95)})
    assert banded.highlights()[0] == ("peak at a", "1000 g (900 to 1200 g)")


def test_a_key_number_has_no_more_digits_than_a_sentence():
    exact = Quantity("N", "kN", digits=7)

    @declare.dataclass
    class Exact(Planted):
        """A result with a number of seven digits."""

        force: float = declare.number(exact, "a force", headline="force", default=12345.678)

    assert dict(Exact((), 1.0).highlights())["force"] == "12.35 kN"


def test_table_of_screen_and_page(result):
    table = faces.face_table(result, "places")
    assert table.caption == "The places"
    assert list(table.columns) == ["place", "planted peak (g)", "length (mm)"]
    assert table.cells() == [["a", "1000.0", "2"], ["b", "2000.0", "4"]]


def test_what_is_infinite_is_a_dash_as_it_is_null_in_the_document(result):
    endless = dataclasses.replace(result, places=(Row("a", float("inf"), 0.002, {}),), planted=float("inf"))
    assert faces.face_table(endless, "places").cells() == [["a", "–", "2"]]
    assert endless.highlights() == [("peak at a", "–"), ("planted number", "–")]
    assert endless.document()["planted"] is None


def test_words_in_a_list_stand_behind_one_another_and_none_are_a_dash():
    @declare.dataclass
    class Listed:
        """Names."""

        names: list[str] = declare.word("names", column=MAIN)

    [column] = faces.columns_of(Listed, [Listed(names) for names in (["a", "b"], ("c",), [])])
    assert column.texts() == ["a, b", "c", "–"]


def test_a_truth_that_is_wanted_is_good_where_it_holds():
    @declare.dataclass
    class Kept:
        """Whether a limit is kept, and whether it was cut."""

        kept: bool = declare.word("whether it is kept", column=MAIN, is_tag=True)
        cut: bool = declare.word("whether it was cut", label="cut off", column=MAIN)

    columns = faces.columns_of(Kept, [Kept(True, False), Kept(False, True)])
    assert [column.cells() for column in columns] == [
        [Tag("yes", "good"), Tag("no", "bad")],
        [Tag("no"), Tag("cut off", "bad")],
    ]


def test_a_band_of_a_row_takes_digits_of_that_row_alone(result):
    banded = dataclasses.replace(result, band={"at.a.peak": Band(800.0 * G, 1500.0 * G, 0.95)})
    assert [row[1] for row in faces.face_table(banded, "places").cells()] == ["1000", "2000.0"]


def test_a_band_of_a_row_is_found_by_its_name_whatever_that_is(result):
    far = dataclasses.replace(result.places[0], name="far end.{x}")
    banded = dataclasses.replace(
        result, places=(far, result.places[1]), band={"at.far end.{x}.peak": Band(800.0 * G, 1500.0 * G, 0.95)}
    )
    assert [row[1] for row in faces.face_table(banded, "places").cells()] == ["1000", "2000.0"]
    assert banded.highlights()[0] == ("peak at far end.{x}", "1000 g (800 to 1500 g)")


def test_a_band_of_a_column_takes_digits_of_all_its_rows(result):
    columns = faces.columns_of(Row, result.places, bands={"peak": [Band(800.0 * G, 1500.0 * G, 0.95)]})
    assert columns[1].texts() == ["1000", "2000"]


def test_notebook_shows_what_is_not_left_out_first_and_python_has_all(result):
    assert shown_table(result, 1) == (["place", "planted peak (g)", "s planted peak (g)"], [["a", "1000.0", "500"]])
    columns = result.columns()
    assert [(one.name, one.si) for one in columns] == [
        ("name", ""), ("peak", "m/s^2"), ("length", "m"), ("s peak", "m/s^2"), ("s clipped", ""),
    ]  # fmt: skip
    assert csv_table(columns).splitlines()[1:] == ["a,9806.65,0.002,4903.325,True", "b,19613.3,0.004,,"]


def test_workbook_and_page_show_the_planted_number(result):
    sheets = {title: [list(row) for row in rows] for title, _, rows in _sheets(result)}
    assert ["planted number", dict(result.highlights())["planted number"]] in sheets["summary"]
    assert [row[1] for row in sheets["table"]] == [1000.0 * G, 2000.0 * G]
    page = plain_page(result, result.highlights(), None, *shown_table(result))
    assert "planted number" in page


def test_units_that_are_chosen_hold_on_all_of_them(result):
    with showing(ShownUnits.read("m/s^2")):
        assert dict(result.highlights())["peak at a"] == "9807 m/s²"
        assert faces.face_table(result, "places").columns[1] == "planted peak (m/s²)"
        assert shown_table(result)[0][1] == "planted peak (m/s²)"


@declare.dataclass
class Typed:
    """A value in the unit of its channel."""

    channel: str = declare.word("its channel", column=KEY)
    value: float = declare.number(
        Quantity.of_data("as the channel", "value"), "what it is", column=MAIN, headline="at {name}"
    )
    si: str = ""
    usual: str = ""

    @property
    def given_units(self):
        return {"as the channel": (self.si, self.usual)} if self.si else {}


@declare.dataclass
class Channels(Planted):
    """A result whose units the data decide."""

    main_rows: ClassVar[str] = "values"

    values: tuple[Typed, ...] = declare.rows(Typed, "the values", default=(), headline="each")

    @property
    def given_units(self):
        units = {(row.si, row.usual) for row in self.values}
        return {"as the channel": units.pop()} if len(units) == 1 else {}


def test_a_unit_that_all_rows_share_stands_in_the_head():
    same = Channels((), 1.0, values=(Typed("a", 2.0 * G, "m/s^2", "g"), Typed("b", 3.0 * G, "m/s^2", "g")))
    assert shown_table(same) == (["channel", "value (g)"], [["a", "2"], ["b", "3"]])
    assert same.columns()[1].si == same.document()["units"]["value"] == "m/s^2"
    assert same.highlights()[1:] == [("at ", "2 g"), ("at ", "3 g")]


def test_a_unit_that_rows_do_not_share_stands_beside_each_number():
    mixed = Channels((), 1.0, values=(Typed("a", 2.0 * G, "m/s^2", "g"), Typed("b", 3.0, "N", "kN"), Typed("c", 4.0)))
    assert shown_table(mixed) == (["channel", "value"], [["a", "2 g"], ["b", "0.003 kN"], ["c", "4 (no unit)"]])
    assert mixed.columns()[1].si == ""
    assert mixed.document()["units"]["value"] == "as the channel"
    assert [text for _, text in mixed.highlights()][1:] == ["2 g", "0.003 kN", "4"]


def test_a_table_of_chosen_columns_is_itself_in_python_and_shows_those_with_a_unit():
    @declare.dataclass
    class Chosen(Planted):
        """A result with a table that the user chose."""

        main_rows: ClassVar[str] = "runs"
        is_history: ClassVar[bool] = True
        runs: list[Column] = declare.table("the runs", default=())

    columns = [
        Column("run", range(1, 6), shown=""),
        Column("x", [G * k for k in range(5)], "m/s^2", shown="g"),
        Column("y", "abcde"),
        Column("cv", [0.01 * k for k in range(5)], "1", shown="%", label="variation"),
    ]
    chosen = Chosen((), 1.0, runs=columns)
    assert chosen.columns() == columns
    assert shown_table(chosen, 3) == (
        ["run", "x (g)", "variation (%)"], [["1", "0", "0"], ["3", "2", "2"], ["5", "4", "4"]],
    )  # fmt: skip
    assert "runs" not in chosen.document()


SHARE = Quantity("1", "%", "share", 2, 0)


@declare.dataclass
class Ranged:
    """A number over some runs: which one the user chose, and with it the digits."""

    name: str = declare.word("its name", label="number", column=KEY)
    least: float | None = declare.number(Quantity.of_data("as the number"), "smallest", column=MAIN)
    quantity: Quantity = SHARE

    @property
    def given_units(self):
        return {"as the number": self.quantity}

    @declare.computed(
        declare.word(
            "from the smallest on", quantity=Quantity.of_data("as the number", "extent"), column=MAIN, headline="{name}"
        )
    )
    def extent(self):
        """What a cell says of it."""
        return None if self.least is None else f"from {faces.text_of(self, 'least', self.given_units)}"


@declare.dataclass
class Ranges(Planted):
    """A result with numbers that the user chose."""

    ranges: tuple[Ranged, ...] = declare.rows(Ranged, "the numbers", default=(), headline="2", in_document=False)


def test_a_number_that_is_chosen_has_unit_and_digits_of_its_own():
    rows = (Ranged("cv", 0.01), Ranged("peak", 30000.2 * G, PEAK), Ranged("none", None), Ranged("late", 1.0))
    study = Ranges((), 1.0, ranges=rows)
    assert faces.face_table(study, "ranges").cells() == [
        ["cv", "1.00 %", "from 1.00 %"], ["peak", "30000 g", "from 30000 g"], ["none", "–", "–"],
        ["late", "100.00 %", "from 100.00 %"],
    ]  # fmt: skip
    assert [column.words for column in faces.columns_of(Ranged, rows)] == [True, False, False]


def test_key_numbers_are_taken_of_so_many_rows():
    rows = (Ranged("cv", 0.01), Ranged("peak", 30000.2 * G, PEAK), Ranged("late", 1.0))
    assert Ranges((), 1.0, ranges=rows).highlights()[1:] == [("cv", "from 1.00 %"), ("peak", "from 30000 g")]


@declare.dataclass
class Marked:
    """A row whose mark is for readers, and whose route is for data."""

    name: str = declare.word("name")
    mark: str = declare.word("name, marked", column=MAIN, in_document=False)
    needs: tuple[str, ...] = declare.word("what it takes", default=(), column=MAIN)
    route: str = declare.word("by which route", default="exact", in_document=False)


@declare.dataclass
class Counted(Planted):
    """A result whose rows are counted."""

    main_rows: ClassVar[str] = "marks"

    marks: tuple[Marked, ...] = declare.rows(Marked, "the rows", headline="count", label="marked rows")


def test_words_of_faces_alone_and_lists_are_no_data_and_rows_are_counted():
    counted = Counted((), 1.0, (Marked("a", "! a !", ("c", "d")), Marked("b", "b")))
    assert ("marked rows", "2") in counted.highlights()
    assert [column.name for column in counted.columns()] == ["name", "route"]
    assert shown_table(counted) == (["mark", "needs"], [["! a !", "c, d"], ["b", "–"]])


def test_the_screen_prints_rows_as_the_page_has_them(result, capsys):
    terminal.print_face(result, "places", "Places")
    printed = capsys.readouterr().out.split()
    assert printed[:1] == ["Places"]
    assert all(cell in printed for row in faces.face_table(result, "places").cells() for cell in row)
    terminal.print_face(dataclasses.replace(result, places=()), "places", "Places")
    assert not capsys.readouterr().out


def test_rows_of_faces_alone_are_made_anew_in_the_units_shown():
    @declare.dataclass
    class Said(Planted):
        """A result with rows whose words say numbers."""

        @declare.computed(declare.rows(Ranged, "said", in_document=False))
        def said(self):
            """A row whose name says the planted number."""
            return [Ranged(faces.amount(PEAK, self.planted), None)]

    said = Said((), 1000.0 * G)
    with showing(ShownUnits.read("m/s^2")):
        assert faces.face_table(said, "said").cells()[0][0] == "9807 m/s²"
    assert faces.face_table(said, "said").cells()[0][0] == "1000 g"


@declare.dataclass
class Sampled:
    """A mean and a share with what is known of them."""

    mean: float = declare.number(
        Quantity.of_data("as the number", "mean", digits=5), "mean", column=MAIN, bounds="low high"
    )
    share: float = declare.number(
        Quantity("1", "%", digits=3), "share", column=MAIN, error="standard_error", bounds="share_low share_high"
    )
    low: float = declare.number(declare.NOT_MEASURED, "its low bound", default=0.0)
    high: float = declare.number(declare.NOT_MEASURED, "its high bound", default=2.0)
    standard_error: float | None = declare.number(declare.NOT_MEASURED, "its standard error", default=None)
    share_low: float = declare.number(declare.NOT_MEASURED, "low bound of the share", default=1e-9)
    share_high: float = declare.number(declare.NOT_MEASURED, "its high bound", default=0.5)
    given_units: ClassVar = {"as the number": Quantity("m/s^2", "g", digits=5)}


def test_bounds_stand_in_a_column_of_their_own_and_a_standard_error_beside_its_share():
    rows = (
        Sampled(1234.56 * G, 0.25, 1234.0 * G, 1235.04 * G, 0.03),
        Sampled(G, 0.25, float("nan"), G),
        Sampled(G, 1e-9, standard_error=float("inf")),
    )
    columns = faces.columns_of(Sampled, rows)
    assert [one.head for one in columns] == ["mean", "95 % bounds", "share (%)", "95 % bounds of the share (%)"]
    assert [one.priority for one in columns] == [MAIN, MAIN, MAIN, MORE]
    assert [one.texts() for one in columns] == [
        ["1234.6 g", "1 g", "1 g"],
        ["1234 to 1235.0", "–", "0 to 0.20394"],
        ["25 ± 3", "25", "< 1e-4"],
        ["< 1e-4 to 50"] * 3,
    ]
    assert faces.text_of(rows[2], "share") == "< 1e-4 %"


@declare.dataclass
class Closing:
    """By how much a sum misses, and how late it is."""

    off: float = declare.number(Quantity("1", "%", "off", 2, 0), "off", column=MAIN, headline="misses by")
    late: float | None = declare.number(
        Quantity("s", "us", "late", 1, 0, signed=True), "late", column=MAIN, headline="late by"
    )


@declare.dataclass
class Closed(Planted):
    """A result with one part, whose numbers are key numbers."""

    closing: Closing = declare.part(Closing, "how it closes", headline="first", default=Closing(0.01234, 2e-6))


def test_key_numbers_of_a_part_are_those_of_its_fields(result):
    closed = Closed(result.places, 1.0)
    assert closed.highlights()[1:] == [
        ("planted number", "0.1020 g"), ("misses by", "1.23 %"), ("late by", "+2.0 µs"),
    ]  # fmt: skip
    assert "late by" not in dict(Closed((), 1.0, closing=Closing(0.5, None)).highlights())
    assert len(Closed((), 1.0, closing=None).highlights()) == 1


def test_per_cent_and_a_number_with_a_sign_have_the_same_decimals_in_tables_and_sentences():
    early = Closing(-0.5, -2e-6)
    assert [column.texts() for column in faces.columns_of(Closing, [early])] == [["-50.00"], ["-2.0"]]
    assert [faces.text_of(early, name) for name in ("off", "late")] == ["-50.00 %", "-2.0 µs"]
    assert faces.text_of(Closing(float("nan"), None), "off") == faces.text_of(Closing(0.0, None), "late") == "–"
    assert faces.text_of(Closing(0.0, 0.0), "late") == "+0.0 µs"


def test_a_cell_with_its_unit_has_the_digits_of_the_table():
    @declare.dataclass
    class Exact:
        """A force known well, and one not at all."""

        force: float = declare.number(Quantity("N", "kN", digits=6), "a force")
        other: float = declare.number(Quantity("1", "1", decimals=5, digits=0), "a ratio")

    exact = Exact(12345.678, 1.0)
    assert [faces.cell_text(exact, name) for name in ("force", "other")] == ["12.3457 kN", "1.00000"]
    assert faces.text_of(exact, "force") == "12.35 kN"
    assert faces.cell_text(Exact(float("nan"), float("inf")), "other") == "–"
    assert faces.cell_text(Exact(float("nan"), 1.0), "force") == "–"


@declare.dataclass
class Spoken:
    """A value with words of its own, and a part of which one line may stand in the same table."""

    peak: float = declare.number(PEAK, "planted", column=MAIN, tables="short")
    closing: Closing | None = declare.part(Closing, "how it closes", default=None)

    @declare.phrase("so", column=MAIN, tables="short long")
    def text(self):
        """Return the peak, in the unit that is shown."""
        return faces.text_of(self, "peak")

    @declare.phrase("small", column=MAIN, tables="long")
    def small(self):
        """Return a tag of another word than its colour."""
        return Tag("small", "good") if self.peak < G else None


def test_lines_are_those_of_one_table_and_leave_out_what_is_missing():
    long = faces.line_table(Spoken(2.0 * G), "long", "All", "of it")
    assert (long.caption, long.columns, long.cells()) == ("All", ["of it", "value"], [["so", "2 g"]])
    assert faces.line_table(Spoken(0.0), "long", "", "").cells()[1] == ["small", Tag("small", "good")]
    whole = faces.line_table(Spoken(2.0 * G, Closing(0.5, None)), "", "", "").cells()
    assert [name for name, _ in whole] == ["planted peak (g)", "off (%)", "so"]


def test_words_of_faces_alone_follow_the_units_that_are_chosen_later():
    spoken = Spoken(2.0 * G)
    assert spoken.text == "2 g"
    with showing(ShownUnits.read("m/s^2")):
        assert spoken.text == "19.61 m/s²"


def test_a_part_says_who_gave_its_numbers_and_nothing_is_a_dash():
    @declare.dataclass
    class Pair:
        """A number by two codes."""

        title: str = declare.word("title", column=KEY)
        theirs: Reading | None = declare.part(Reading, "of another code", label="theirs")

    columns = faces.columns_of(Pair, [Pair("", None)])
    assert [one.head for one in columns] == ["title", "planted peak, theirs (g)", "clipped, theirs"]
    assert [one.texts() for one in columns] == [["\N{EN DASH}"]] * 3
    assert [leaf.headline for _, leaf in faces.leaves(Pair) if leaf.headline] == ["sensor {name}, theirs"]


def test_a_table_without_rows_says_why(result):
    nothing = dataclasses.replace(result, places=())
    assert faces.face_table(nothing, "places", empty="No place is there.").empty == "No place is there."


def test_a_part_that_is_kept_as_a_dictionary_has_its_lines():
    @declare.dataclass
    class Kept(Planted):
        """A result with a part by its keys."""

        reading: dict[str, float] = declare.part(Reading, "what a sensor shows", default=None)

    (table,) = faces.part_tables(Kept((), 1.0, {"peak": G}), "reading")
    assert table.cells() == [["planted peak (g)", "1.000"]]


@pytest.mark.parametrize("name", ["columns_of", "heads_and_cells", "array_columns", "shown_columns"])
def test_no_two_functions_that_make_columns_have_one_name(name):
    sources = (path.read_text("utf-8") for path in Path(strikewave.__file__).parent.rglob("*.py"))
    assert sum(len(re.findall(rf"def {name}\(", text)) for text in sources) == (name != "shown_columns")
