"""What ISO/IEC 17025:2017 asks of a test report, in our words, and what of it a test file does not state.

Quoted: 7.8.2.1 and 7.8.6 from copies of the text in public places, 7.8.3.1 from that of the edition of 2005, 5.10.3.1,
which has the same; the standard itself was not at hand. What the report always holds (title, specification, results
with units, that they relate to the items tested, decision rule) is not listed, nor what a shock test does not have
(sampling).
"""

from __future__ import annotations

from typing import NamedTuple

from strikewave.cases.stated_test import StatedTest

NORM = "ISO/IEC 17025:2017"


class Asked17025(NamedTuple):
    """One thing that is asked for: the clause, what, and where a test file states it."""

    clause: str
    what: str
    key: str


def missing(stated: StatedTest, uncertainty: bool) -> list[Asked17025]:
    """Return what is asked for and not stated; ``uncertainty`` tells whether that of the measurement is.

    Examples
    --------
    >>> from strikewave.cases.tables.common import PerformedTest
    >>> [one.key for one in missing(StatedTest(PerformedTest(item="board", laboratory="hall 3")), True)][:3]
    ['report.laboratory_address', 'report.number', 'customer.name, customer.contact']
    """
    test, tables = stated.test, stated.tables
    report, customer, items = tables.report, tables.customer, tables.specimen
    named = bool(test.item or (items and all(one.name for one in items)))
    numbered = bool(test.serial_number or (items and all(one.serial_number for one in items)))
    calibrated = bool(tables.equipment) and all(one.calibrated and one.certificate for one in tables.equipment)
    rows = [
        (test.laboratory, "7.8.2.1 b", "name of the laboratory", "test.laboratory"),
        (report.laboratory_address, "7.8.2.1 b, c", "its address, and where the test was done",
         "report.laboratory_address"),
        (report.number, "7.8.2.1 d", "unique number of the report", "report.number"),
        (customer.name and customer.contact, "7.8.2.1 e", "customer and contact", "customer.name, customer.contact"),
        (named, "7.8.2.1 g", "description of each item", "specimen.name"),
        (numbered, "7.8.2.1 g", "what tells each item from others", "specimen.serial_number"),
        (items and all(one.condition for one in items), "7.8.2.1 g", "condition of each item, where it matters",
         "specimen.condition"),
        (items and all(one.received for one in items), "7.8.2.1 h", "date of receipt, where it matters",
         "specimen.received"),
        (test.date, "7.8.2.1 i", "date of the test", "test.date"),
        (report.issued, "7.8.2.1 j", "date of issue", "report.issued"),
        (report.deviations, "7.8.2.1 n", "deviations from the method, or that there were none", "report.deviations"),
        (any(one.name for one in tables.signature), "7.8.2.1 o", "who authorizes the report", "signature.name"),
        (tables.environment.temperature, "7.8.3.1 a", "conditions of the surroundings, where they matter",
         "environment.temperature"),
        (uncertainty, "7.8.3.1 c", "uncertainty of the measurement, where it bears on the verdict",
         "option --uncertainty"),
        (calibrated, "6.5, not 7.8", "equipment, with dates and certificates of calibration", "equipment"),
    ]  # fmt: skip
    return [Asked17025(*row) for given, *row in rows if not given]
