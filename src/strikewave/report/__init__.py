"""The report of a run: one HTML file that needs nothing else; see `report`."""

from strikewave.report.page import bar_report, report
from strikewave.report.parts import Code, Flow, Picture, Section, Table, Tag

__all__ = ["Code", "Flow", "Picture", "Section", "Table", "Tag", "bar_report", "report"]
