"""The result of every command: one `Result` for pages, screens, files and JSON, and one `Notice` for all warnings."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import nan
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple

from strikewave._version import __version__
from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, NO_UNIT, NOT_MEASURED, GivenUnits, Quantity
from strikewave.base.documents import SCHEMA as DOCUMENT_SCHEMA
from strikewave.base.documents import json_text, plain
from strikewave.base.shock_quantities import OF_PUBLISHED, PUBLISHED_QUANTITIES

if TYPE_CHECKING:
    import xarray

    from strikewave.base.datasets import LabelledArrays

SCHEMA = 9
"""Version of the files of a solution: 2 adds readings and waves, 3 the contact of each blow; 4 renames keys (balance);
5 adds the side force of each blow and the answers of its contact; 6 adds the bands, 7 the contact time of each blow; 8
keeps blows and readings for as long as their pulses last; 9 takes velocity_change of the pulse, blow_velocity_change of
the whole blow, and the zero of a sensor that falls in the fall."""
ELEMENTS_SCHEMA = 2
"""Version of the file of histories of elements: 2 has forces, impulses, energies and momentum of whole bodies where
sectors are meshed. It stands here because the keys of runs hold it, and are made without importing elements."""
Severity = Literal["info", "warning", "failed"]
INFO: Severity = "info"
WARNING: Severity = "warning"
FAILED: Severity = "failed"
"""Severity of a notice; see `Notice`."""
BALANCE_LIMIT = 1e-6  # a thousand times what usual runs leave (li-ma-2019: 4e-10): beyond it is a fault, not rounding
"""Share of energy or momentum beyond which a missing one fails the check of its balance."""


@declare.dataclass
class Notice:
    r"""A fact, a warning or a failed check that the user should know.

    In its message a number is joined to its unit by a no-break space where readers may choose the unit
    (``5.2\xa0kN``).
    """

    code: str = declare.word("short name, such as contact-yield")
    message: str = declare.word("what, where and how much, and what to do")
    value: float = declare.number(NOT_MEASURED, "the number that raised it, SI; null where there is none", default=nan)
    limit: float = declare.number(NOT_MEASURED, "what that is held against, SI; null where there is none", default=nan)
    severity: Severity = declare.word(
        "info, a fact that belongs to the result; warning, it may be wrong, or not what was meant; failed, a check: "
        "exit code 3",
        default=WARNING,
    )
    case: str = declare.word("name of the case, where a result is made of several", default="", in_document=False)

    @declare.computed(declare.word("name of the case, where a result is made of several", key="case", optional=True))
    def named_case(self) -> str | None:
        """Name of the case; None where there is but one."""
        return self.case or None

    @property
    def broken(self) -> bool:
        """True if the notice is a failed check."""
        return self.severity == FAILED

    def document(self) -> dict[str, Any]:
        """Return the row of the JSON document.

        Examples
        --------
        >>> Notice("clipped", "the sensor clips", 3.0, 2.0).document()
        {'code': 'clipped', 'message': 'the sensor clips', 'value': 3.0, 'limit': 2.0, 'severity': 'warning'}
        """
        return declare.content(self)


Status = Literal["passed", "broken", "failed"]
RUN_PASSED: Status = "passed"
RUN_BROKEN: Status = "broken"
RUN_FAILED: Status = "failed"
RUN_STATUSES = (RUN_PASSED, RUN_BROKEN, RUN_FAILED)
"""Outcomes of the checks of a run: all passed; a check failed; the run could not be made."""
FailOn = Literal["failed", "broken", "never"]
"""Outcomes that make a command end with `EXIT_BROKEN`: a run that could not be made; a failed check too; nothing."""
EXIT_BROKEN = 3
"""Exit code of a command whose result, or one of whose runs, failed a check, or that missed its goal."""
VERDICT = "verdict"
"""Attribute of a NetCDF file with the verdict of its result."""
MOST_CODES = 3  # more would not be read; the notice has them all
"""Broken checks that a sentence names."""


@dataclass(frozen=True)
class Verdict:
    """Outcome of the checks of a run, decided where the run is made; a study keeps its text, faces ask it."""

    status: Status
    """Word "passed", "broken" (a check failed) or "failed" (the run could not be made)."""
    codes: tuple[str, ...] = ()
    """Codes of the checks that failed, such as ``blow-count``."""
    not_judged: tuple[str, ...] = ()
    """Checks that the engine cannot make, such as ``momentum-balance`` of a fast run."""

    @classmethod
    def of(cls, notices: Iterable[Notice], not_judged: Sequence[str] = ()) -> Verdict:
        """Return the verdict of the notices of a run: broken where one of them is a failed check.

        Examples
        --------
        >>> Verdict.of([Notice("blow-count", "12 blows", severity=FAILED), Notice("blow-kind", "1 glancing")]).text
        'broken: blow-count'
        """
        codes = tuple(dict.fromkeys(notice.code for notice in notices if notice.broken))
        return cls(RUN_BROKEN if codes else RUN_PASSED, codes, tuple(not_judged))

    @property
    def text(self) -> str:
        """The verdict as a cell of a table: status, and which checks failed."""
        return f"{self.status}: {', '.join(self.codes)}" if self.codes else self.status


def status_of(text: str) -> str:
    """Return the status of the text of a verdict.

    Examples
    --------
    >>> status_of("broken: blow-count"), status_of("")
    ('broken', '')
    """
    return text.partition(":")[0]


def worse(first: str, second: str) -> str:
    """Return the text of the worse of two verdicts; one that is not known is no worse.

    Examples
    --------
    >>> worse("passed", "broken: no-blow"), worse("passed", ""), worse("of another program", "passed")
    ('broken: no-blow', 'passed', 'passed')
    """
    rank: dict[str, int] = {status: place for place, status in enumerate(RUN_STATUSES, start=1)}
    return max(first, second, key=lambda text: rank.get(status_of(text), 0))


@declare.dataclass
class VerdictCounts:
    """Numbers of runs by their outcome."""

    passed: int = declare.count("runs that passed their checks")
    broken: int = declare.count("runs that failed one")
    failed: int = declare.count("runs that could not be made")


class Verdicts:
    """Verdicts of the runs that a result is made of.

    The text of a run is empty where none is known, as of runs kept by an older version; ``noun`` is one for the runs,
    in the plural, and ``reason`` says why one of the failed runs could not be made. The ``deciding`` verdicts, all of
    them by default, make the exit code: of a search those of its offers, for a try on the way is no part of the answer.

    Examples
    --------
    >>> verdicts = Verdicts(["passed", "broken: blow-count", "failed"])
    >>> verdicts.words
    '1 of 3 runs failed a check (blow-count), 1 could not be made'
    >>> verdicts.document(), verdicts.fails("failed"), verdicts.fails("never")
    ({'passed': 1, 'broken': 1, 'failed': 1}, True, False)
    """

    def __init__(
        self,
        texts: Iterable[str],
        noun: str = "runs",
        reason: str = "",
        not_judged: Sequence[str] = (),
        deciding: Iterable[str] | None = None,
    ) -> None:
        self.texts = tuple(texts)
        self.deciding = self.texts if deciding is None else tuple(deciding)
        self.noun, self.reason, self.not_judged = noun, reason, tuple(not_judged)
        self.statuses = tuple(map(status_of, self.texts))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Verdicts) and vars(self) == vars(other)

    def __hash__(self) -> int:
        return hash(tuple(vars(self).values()))

    def count(self, status: str) -> int:
        """Return how many runs have a status; those of "" are not judged."""
        return self.statuses.count(status)

    @property
    def marked(self) -> tuple[bool, ...]:
        """True for each run that is to be marked: it broke a limit, or failed."""
        return tuple(status in (RUN_BROKEN, RUN_FAILED) for status in self.statuses)

    @property
    def codes(self) -> dict[str, int]:
        """The checks that failed, the most frequent first, with the number of runs."""
        codes = (code for text in self.texts for code in text.partition(": ")[2].split(", ") if code)
        return dict(Counter(codes).most_common())

    def counted(self, status: str) -> str:
        """Return "1 of 3 runs", or "the run" where it is the only one."""
        if len(self.texts) == self.count(status) == 1:
            return f"the {self.noun.removesuffix('s')}"
        return f"{self.count(status)} of {len(self.texts)} {self.noun}"

    @property
    def words(self) -> str:
        """The numbers of runs that broke a limit, or failed, in words; empty where none did."""
        parts = []
        if self.count(RUN_BROKEN):
            parts.append(f"{self.counted(RUN_BROKEN)} failed a check ({', '.join([*self.codes][:MOST_CODES])})")
        if self.count(RUN_FAILED):
            count = str(self.count(RUN_FAILED)) if parts else self.counted(RUN_FAILED)
            parts.append(f"{count} could not be made")
        return ", ".join(parts)

    @property
    def sentence(self) -> str:
        """The same as a sentence; empty where none did."""
        return f"{self.words[0].upper()}{self.words[1:]}." if self.words else ""

    def document(self) -> dict[str, int]:
        """Return the counts for the JSON document."""
        return declare.content(VerdictCounts(*map(self.count, RUN_STATUSES)))

    def fails(self, fail_on: str) -> bool:
        """Tell whether the command ends with `EXIT_BROKEN`; "broken" includes what failed."""
        statuses = {"failed": (RUN_FAILED,), "broken": (RUN_BROKEN, RUN_FAILED)}.get(fail_on, ())
        return any(status_of(text) in statuses for text in self.deciding)

    def notices(self) -> tuple[Notice, ...]:
        """Return notices on them: how many broke a limit or failed, and which checks were not made."""
        several = len(self.texts) > 1
        checks = ", ".join(f"{code} in {count}" if several else code for code, count in self.codes.items())
        such = f", such as: {self.reason}" if self.reason else ""
        listed = []
        for status, code, fault in (
            (RUN_BROKEN, "runs-broken", f"failed a check: {checks}"),
            (RUN_FAILED, "runs-failed", f"could not be made{such}"),
        ):
            if count := self.count(status):
                severity = FAILED if status in map(status_of, self.deciding) else WARNING
                listed.append(Notice(code, f"{self.counted(status)} {fault}", float(count), severity=severity))
        if self.count(""):
            message = (
                f"{self.count('')} of {len(self.texts)} {self.noun} are from a version that kept no verdicts: "
                "whether a limit was broken is not known; --fresh makes them anew"
            )
            listed.append(Notice("runs-not-judged", message, float(self.count(""))))
        if self.not_judged:
            message = (
                f"the {self.noun} are of an engine that does not judge {' and '.join(self.not_judged)}: a full run does"
            )
            listed.append(Notice("checks-not-made", message, severity=INFO))
        return tuple(listed)


NO_RUNS = Verdicts(())
"""Verdicts of a result that is not made of runs."""


@declare.dataclass
class Comparison:
    """Comparison of a computed number with the published one, both in the SI unit of the quantity."""

    quantity: str = declare.word("which number, such as first.rigid_peak", column=KEY)
    published: float = declare.number(OF_PUBLISHED, "the published number", column=MAIN)
    measured_or_simulated: str = declare.word("how it was found by those who published it", column=MAIN)
    computed: float | None = declare.number(OF_PUBLISHED, "ours; null where the run has none", column=MAIN)
    difference: float | None = declare.number(Quantity(NO_UNIT, "%"), "(computed - published) / published", column=MAIN)
    role: str = declare.word("fitted, it chose a value; predicted; or shown, not comparable", column=MAIN)
    note: str = declare.word(
        "why it is not comparable, or what else is said of it", default="", column=MAIN, in_document=False
    )
    sensor: str = declare.word("which sensor it is of, where it is of one", default="", column=MAIN, in_document=False)

    @property
    def measured(self) -> Quantity:
        """The quantity of both numbers."""
        return PUBLISHED_QUANTITIES[self.quantity]

    @property
    def given_units(self) -> GivenUnits:
        """Unit of both numbers."""
        return {OF_PUBLISHED.given_by: self.measured.units}


class BalanceCheck(NamedTuple):
    """An error of a balance beside its limit, which is that of the analysis."""

    name: str
    error: float
    """Share that is missing, with its sign where that tells something."""
    limit: float = BALANCE_LIMIT
    share_of: str = ""
    """Reference of both shares, where that is stated."""

    @property
    def holds(self) -> bool:
        """True if the error is within the limit; False for NaN."""
        return abs(self.error) <= self.limit

    @property
    def limit_text(self) -> str:
        """The limit to one digit."""
        return f"{self.limit:.0e}".replace("e-0", "e-")

    @property
    def words(self) -> str:
        """Error and limit.

        Examples
        --------
        >>> BalanceCheck("energy", -3.61e-5, 0.01).words, BalanceCheck("momentum", 2e-15).words
        ('energy -3.6e-05 (limit 1e-2)', 'momentum 2.0e-15 (limit 1e-6)')
        """
        return f"{self.name} {self.error:.1e} (limit {self.limit_text})"


@declare.dataclass
class InputShare:
    """Share of one input in the variance of a result."""

    field: str = declare.word(
        "path of an input in the case, or of what a named material stands for, material.PTFE.modulus"
    )
    share: float = declare.number(NOT_MEASURED, "its share of the variance of the number")
    standard_error: float = declare.number(
        NOT_MEASURED, "of that share, from the regression; null where it is not known", default=nan
    )


@declare.dataclass
class Band:
    """The range of a result when inputs move within what is known of them; no error bar of the model."""

    low: float = declare.number(NOT_MEASURED, "its lower end, in the SI unit of the result")
    high: float = declare.number(NOT_MEASURED, "its upper end")
    level: float = declare.number(NOT_MEASURED, "share of the draws that lie within")
    inputs: tuple[InputShare, ...] = declare.rows(
        InputShare, "the inputs that matter most, largest share first", default=()
    )

    def document(self) -> dict[str, Any]:
        """Return the entry of the JSON document.

        Examples
        --------
        >>> Band(1.0, 2.0, 0.95, (InputShare("machine.engagement", 0.5, 0.1),)).document()["inputs"]
        [{'field': 'machine.engagement', 'share': 0.5, 'standard_error': 0.1}]
        """
        return declare.content(self)

    @classmethod
    def read(cls, document: Mapping[str, Any]) -> Band:
        """Return the band of an entry of the JSON document, in which NaN is null."""
        rows = [{key: value for key, value in row.items() if value is not None} for row in document["inputs"]]
        return cls(**{**document, "inputs": tuple([InputShare(**row) for row in rows])})


@declare.dataclass
class MovedInput:
    """An input that moved."""

    field: str = declare.word("path of an input that moved")
    typed: str | int | float = declare.word("its value as typed")
    low: float = declare.number(NOT_MEASURED, "low end of its range, SI")
    high: float = declare.number(NOT_MEASURED, "high end of its range, SI")
    unit: str = declare.word("its SI unit")
    basis: str = declare.word("what the range rests on: a tolerance, a plausible range, a fit, or none of them")
    reason: str = declare.word("why it is so wide")


@declare.dataclass
class BandMethod:
    """Method by which the bands of a result were found."""

    engine: str = declare.word("what ran, in words")
    level: float = declare.number(NOT_MEASURED, "share of the draws within a band")
    seed: int = declare.count("of the draws")
    runs: int = declare.count("how many runs")
    first_runs: int = declare.count("further ones of the first blow alone", default=0)
    missed: int = declare.count("runs in which a striker missed", default=0)
    failed: int = declare.count("runs that could not be made", default=0)
    sensor_runs: int = declare.count("full runs of the first blow for sensors", default=0)
    rest: Mapping[str, float] = declare.number(
        NOT_MEASURED, "of each number, the share of the variance that no input makes by itself", default=dict
    )
    fitted: tuple[str, ...] = declare.word(
        "numbers with the ends of a fit; the others have quantiles of the runs", default=()
    )
    ranked: tuple[str, ...] = declare.word("numbers whose shares are those in the variance of their ranks", default=())
    inputs: tuple[MovedInput, ...] = declare.rows(MovedInput, "what moved", default=())
    why: str = declare.word("why the first of those that could not be made could not", default="")
    broken: int = declare.count(
        "runs that failed a check, a missed blow among them; of sensors and first blows alone it is not judged",
        default=0,
    )

    @declare.computed(declare.word("the method in one line", key="words"))
    def line(self) -> str:
        """The method in one line."""
        return self.words()

    def words(self) -> str:
        """Return the method in one line, with what it leaves out."""
        more = f" and {self.first_runs} of the first blow" if self.first_runs else ""
        full = f", of sensors {self.sensor_runs} full runs of the first blow" if self.sensor_runs else ""
        other = max(self.broken - self.missed, 0)
        counts = (self.missed, "with a miss"), (other, "failed another check"), (self.failed, "failed")
        lost = [f"{count} {what}" for count, what in counts if count]
        among = f" ({', '.join(lost)})" if lost else ""
        return (
            f"{100.0 * self.level:.0f} % of {self.runs} runs{more}{among} by {self.engine}{full}, {len(self.inputs)} "
            "inputs moved within what is known of them; laws and other choices stay, and the error of the "
            "model is not in it"
        )

    def broken_words(self) -> list[str]:
        """Say how many runs of the ranges failed a check; nothing where none did."""
        if not self.broken:
            return []
        return [f"Of the {self.runs} runs of these ranges {self.broken} failed a check."]

    def document(self) -> dict[str, Any]:
        """Return the entry of the JSON document."""
        return declare.content(self)

    @classmethod
    def read(cls, document: Mapping[str, Any]) -> BandMethod:
        """Return the method of an entry of the JSON document."""
        values: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in document.items()}
        del values["words"]
        return cls(**{**values, "inputs": tuple([MovedInput(**row) for row in document["inputs"]])})


@declare.dataclass
class BandContent:
    """The bands in a document."""

    band: Mapping[str, Band] = declare.named(Band, "band of each number that has one")
    band_method: BandMethod | None = declare.part(BandMethod, "how they were found; null where none were asked for")


@declare.dataclass
class DocumentHead:
    """Head of every document."""

    schema: int = declare.count("version of the documents; it rises when a key changes its meaning or goes")
    version: str = declare.word("version of strikewave")
    units: Mapping[str, str] = declare.word("SI unit of each key that has one, by its name")
    warnings: tuple[Notice, ...] = declare.rows(Notice, "what should be known")
    test: Mapping[str, Any] | None = declare.word("what is stated of the test", optional=True)
    verdicts: VerdictCounts | None = declare.part(
        VerdictCounts, "what the runs came to that a result is made of", optional=True
    )


@dataclass(frozen=True)
class Source:
    """Inputs of a result."""

    kind: str
    """Kind of the inputs: case, set-up, records, command, paper."""
    name: str
    text: str
    """TOML that gives the result again or, of measured files, names them by their SHA-256; marks the folder."""
    file: str = "case.toml"
    """Name of the file that holds the text there."""
    digests: Mapping[str, str] = dataclasses.field(default_factory=dict)
    """SHA-256 of the files that were read, by their names."""
    asked: str = ""
    """Command line that gives the result again, as it is to be typed, where the text alone does not."""
    test: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    """Data stated of the test, where no case holds it: texts by the keys of [test], and tables of a test report."""

    @property
    def whole(self) -> bool:
        """True if the text alone gives the result again; else it takes the command line and the files."""
        return self.file == "case.toml"

    @property
    def digest(self) -> str:
        """SHA-256 of the text or, of measured files, of their digests in their order; empty where one is missing."""
        if self.whole:
            return hashlib.sha256(self.text.encode("utf-8", "replace")).hexdigest()
        known = bool(self.digests) and all(self.digests.values())
        return hashlib.sha256("\n".join(self.digests.values()).encode()).hexdigest() if known else ""


@dataclass(frozen=True, kw_only=True)
class Result(ABC):
    """The result of a command, from which page, screen, files and JSON are made."""

    command: ClassVar[str]
    """The command that gives it."""
    data_file: ClassVar[str] = ""
    """Name of the file that keeps its data."""
    may_have_bands: ClassVar[bool] = False
    """True if the JSON document lists the bands of the result."""

    notices: tuple[Notice, ...] = ()
    comparisons: tuple[Comparison, ...] = ()
    """Comparisons of computed numbers with published ones."""
    citations: tuple[str, ...] = ()
    """Keys of the sources of the models used."""
    band: Mapping[str, Band] = dataclasses.field(default_factory=dict)
    """Band of each number that has one, by its name, such as ``first.rigid_peak``; empty where none was asked for."""
    band_method: BandMethod | None = None
    verdicts: Verdicts = NO_RUNS
    """Verdicts of the runs that it is made of; of none where it is one run itself, or made of none."""

    @property
    @abstractmethod
    def title(self) -> str:
        """The head of page, tables and pictures."""

    @property
    @abstractmethod
    def source(self) -> Source:
        """The source of the inputs."""

    @property
    def test(self) -> Mapping[str, Any]:
        """Item, laboratory, place and time of the test, as far as they are stated; see the table [test] of a case.

        Of measured files, tables of a test report may stand beside those texts.
        """
        return {}

    @property
    def named_units(self) -> Mapping[str, str]:
        """SI units of numbers that the document names by their subject, such as published ones."""
        return {}

    @property
    def given_units(self) -> declare.GivenUnits:
        """SI unit and unit shown of numbers whose unit the data decide, by `Quantity.given_by`."""
        return {}

    @property
    def warnings(self) -> tuple[Notice, ...]:
        """The notices, by the key of the JSON document."""
        return self.notices

    @property
    def published(self) -> tuple[Comparison, ...]:
        """The comparisons, by the key of the JSON document."""
        return self.comparisons

    @property
    def balance_checks(self) -> tuple[BalanceCheck, ...]:
        """Each error of a balance (``energy_error``, ``momentum_error``) beside its limit, for all faces."""
        errors: Mapping[str, float] = getattr(self, "balance", {})
        return tuple(BalanceCheck(name.removesuffix("_error"), error) for name, error in errors.items())

    @property
    def broken(self) -> bool:
        """True if a check failed, or a goal was missed: the command exits with 3."""
        return any(notice.broken for notice in self.notices)

    @property
    def own_verdict(self) -> Verdict:
        """The verdict of its own checks; the runs that it is made of have `verdicts`."""
        return Verdict.of(self.notices)

    @property
    def state(self) -> str:
        """The outcome of its checks in words, for all faces."""
        codes = self.own_verdict.codes
        if codes:
            return failed_words(codes)
        count = sum(notice.severity == WARNING for notice in self.notices)
        return f"{count} warning{'s' if count > 1 else ''}" if count else "all checks passed"

    def exit_code(self, fail_on: str = "broken") -> int:
        """Return the exit code of its command, `EXIT_BROKEN` or 0.

        It fails on "broken" where a check failed, a goal was missed, or a run failed a check or could not be made; on
        "failed" where a run could not be made; on "never" nowhere.
        """
        own = fail_on == "broken" and (self.broken or self.own_verdict.status == RUN_BROKEN)
        return EXIT_BROKEN if own or self.verdicts.fails(fail_on) else 0

    def units(self) -> Mapping[str, str]:
        """Return the unit of each key of the JSON document, as its fields declare it."""
        given = {by: one[0] for by, one in self.given_units.items() if one[0]}
        return {**{key: given.get(si, si) for key, si in declare.units(type(self)).items()}, **self.named_units}

    def content(self) -> dict[str, Any]:
        """Return the JSON document without its head: declared fields, and bands."""
        return {**declare.content(self), **(self.band_content() if self.may_have_bands else {})}

    def band_content(self) -> dict[str, Any]:
        """Return the bands of the JSON document; see `Band` and `BandMethod`."""
        return declare.content(BandContent(self.band, self.band_method))

    def document(self) -> dict[str, Any]:
        """Return the JSON document; values that do not exist are null."""
        content = self.content()
        there, declared = set(keys_within(content)), declare.units(type(self))
        units = {key: si for key, si in self.units().items() if key in there or key not in declared}
        counts = VerdictCounts(*map(self.verdicts.count, RUN_STATUSES)) if self.verdicts.texts else None
        begins = DocumentHead(DOCUMENT_SCHEMA, __version__, units, self.notices, dict(self.test) or None, counts)
        return dict(plain({**declare.content(begins), **content}))

    def tables(self) -> dict[str, str]:
        """Return its tables as CSV text, by the names of their files."""
        return {}

    @property
    def arrays(self) -> LabelledArrays | None:
        """Histories with units; None where there are none."""
        return None

    @functools.cached_property
    def data(self) -> xarray.Dataset:
        """Histories with units, as an xarray Dataset; an `AttributeError` where there are none."""
        if self.arrays is None:
            raise AttributeError(f"a result of `strikewave {self.command}` has no histories")
        return self.arrays.to_xarray()

    def datasets(self) -> dict[str, LabelledArrays]:
        """Return the NetCDF files, by their names."""
        if self.arrays is None:
            return {}
        attributes = {**self.arrays.attrs, VERDICT: self.own_verdict.text}
        return {self.data_file: dataclasses.replace(self.arrays, attrs=attributes)}

    def texts(self) -> dict[str, str]:
        """Return further text files, by name."""
        return {}

    def files(self) -> dict[str, str | LabelledArrays]:
        """Return all its files but for page and pictures, by their names."""
        source = self.source
        return {**self.datasets(), **self.tables(), **self.texts(), source.file: source.text}

    def document_text(self, indent: int | None = None) -> str:
        """Return the JSON document as the text of a file."""
        return json_text(self.document(), indent)


def failed_words(codes: Sequence[str]) -> str:
    """Name the checks that failed."""
    return f"check{'s' if len(codes) > 1 else ''} failed: {', '.join(codes)}"


def balance_notices(balance: Mapping[str, float]) -> Iterator[Notice]:
    """Yield each error of a balance (``energy_error``, ``momentum_error``, shares) that is beyond the limit."""
    for key, error in balance.items():
        if not error <= BALANCE_LIMIT:
            name = key.removesuffix("_error")
            message = (
                f"the {name} balance is off by {error:.1e}: lower solver.tolerance (solver.step for a stack), or take "
                "less extreme values"
            )
            yield Notice(f"{name}-balance", message, error, BALANCE_LIMIT, severity=FAILED)


def keys_within(content: Any) -> Iterator[str]:
    """Yield the keys of a document and of all rows and parts within; of a list of rows and of no other.

    Examples
    --------
    >>> sorted(set(keys_within({"blows": [{"peak": 1.0, "time": 2.0}], "values": [1.0, 2.0]})))
    ['blows', 'peak', 'time', 'values']
    """
    if isinstance(content, Mapping):
        yield from map(str, content)
        for inner in content.values():
            yield from keys_within(inner)
    elif isinstance(content, list | tuple) and content and isinstance(content[0], Mapping):
        for row in content:
            yield from keys_within(row)
