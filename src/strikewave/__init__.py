"""strikewave: predict, measure and design high-g impact tests.

Examples
--------
>>> import strikewave
>>> solution = strikewave.run_case(strikewave.load_case("li-ma-2019"))
>>> solution.blows[0].kind
'full'
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from strikewave._version import __version__

if TYPE_CHECKING:  # for type checkers and editors; at run time a name is imported when it is first used
    from strikewave.analyses.compare.limits import Scoring as Scoring
    from strikewave.analyses.compare.result import CompareResult as CompareResult
    from strikewave.analyses.compare.run import compare as compare
    from strikewave.analyses.fem.result import FemSolution as FemSolution
    from strikewave.analyses.fem.run import run_fem as run_fem
    from strikewave.analyses.hopkinson.build import load_setup as load_setup
    from strikewave.analyses.hopkinson.run import run_hopkinson as run_hopkinson
    from strikewave.analyses.machine.result import Solution as Solution
    from strikewave.analyses.machine.result import load_solution as load_solution
    from strikewave.analyses.machine.run import run_case as run_case
    from strikewave.analyses.record.examine import record as record
    from strikewave.analyses.record.file_spectra import shock_spectra as shock_spectra
    from strikewave.analyses.record.options import Examination as Examination
    from strikewave.analyses.record.options import Spectra as Spectra
    from strikewave.analyses.record.result import RecordResult as RecordResult
    from strikewave.analyses.record.specification.synthesis import synthesize as synthesize
    from strikewave.analyses.record.spectrum import SpectrumResult as SpectrumResult
    from strikewave.analyses.wave.result import WaveSolution as WaveSolution
    from strikewave.analyses.wave.run import run_wave as run_wave
    from strikewave.base.constants import material as material
    from strikewave.base.constants import materials as materials
    from strikewave.base.errors import InputError as InputError
    from strikewave.base.errors import StrikewaveError as StrikewaveError
    from strikewave.base.result import Band as Band
    from strikewave.base.result import Result as Result
    from strikewave.cases.case import Case as Case
    from strikewave.cases.case import dump_case as dump_case
    from strikewave.cases.case import load_case as load_case
    from strikewave.contact.identification import identify as identify
    from strikewave.contact.impact import solve_impact as solve_impact
    from strikewave.contact.law import Contact as Contact
    from strikewave.records.measuring import find_pulses as find_pulses
    from strikewave.records.readers import read_record as read_record
    from strikewave.reporting.measured_files import Calibration as Calibration
    from strikewave.reporting.measured_files import Filtering as Filtering
    from strikewave.reporting.measured_files import Judging as Judging
    from strikewave.reporting.measured_files import Reading as Reading
    from strikewave.signal.srs import srs as srs
    from strikewave.studies.buffer.result import BufferStudy as BufferStudy
    from strikewave.studies.buffer.stacks import StackChoices as StackChoices
    from strikewave.studies.buffer.study import buffer as buffer
    from strikewave.studies.engine.runner import Workers as Workers
    from strikewave.studies.fit.result import FitStudy as FitStudy
    from strikewave.studies.fit.study import fit as fit
    from strikewave.studies.map.study import MapStudy as MapStudy
    from strikewave.studies.map.study import map as map
    from strikewave.studies.scatter.study import ScatterStudy as ScatterStudy
    from strikewave.studies.scatter.study import scatter as scatter
    from strikewave.studies.search.design import DesignStudy as DesignStudy
    from strikewave.studies.search.design import design as design
    from strikewave.studies.search.drop_table import DropTableStudy as DropTableStudy
    from strikewave.studies.search.drop_table import drop_table as drop_table
    from strikewave.studies.search.plan import SearchMethod as SearchMethod
    from strikewave.studies.search.rotary import SettingsChoices as SettingsChoices
    from strikewave.studies.search.rotary import SettingsStudy as SettingsStudy
    from strikewave.studies.search.rotary import settings as settings
    from strikewave.studies.sweep.study import SweepStudy as SweepStudy
    from strikewave.studies.sweep.study import sweep as sweep

_HOMES = {
    "Band": "base.result",
    "BufferStudy": "studies.buffer.result",
    "Calibration": "reporting.measured_files",
    "Case": "cases.case",
    "CompareResult": "analyses.compare.result",
    "Contact": "contact.law",
    "DesignStudy": "studies.search.design",
    "DropTableStudy": "studies.search.drop_table",
    "Examination": "analyses.record.options",
    "FemSolution": "analyses.fem.result",
    "Filtering": "reporting.measured_files",
    "FitStudy": "studies.fit.result",
    "InputError": "base.errors",
    "Judging": "reporting.measured_files",
    "MapStudy": "studies.map.study",
    "Reading": "reporting.measured_files",
    "RecordResult": "analyses.record.result",
    "Result": "base.result",
    "ScatterStudy": "studies.scatter.study",
    "Scoring": "analyses.compare.limits",
    "SearchMethod": "studies.search.plan",
    "SettingsChoices": "studies.search.rotary",
    "SettingsStudy": "studies.search.rotary",
    "Solution": "analyses.machine.result",
    "Spectra": "analyses.record.options",
    "SpectrumResult": "analyses.record.spectrum",
    "StackChoices": "studies.buffer.stacks",
    "StrikewaveError": "base.errors",
    "SweepStudy": "studies.sweep.study",
    "WaveSolution": "analyses.wave.result",
    "Workers": "studies.engine.runner",
    "buffer": "studies.buffer.study",
    "compare": "analyses.compare.run",
    "design": "studies.search.design",
    "drop_table": "studies.search.drop_table",
    "dump_case": "cases.case",
    "find_pulses": "records.measuring",
    "fit": "studies.fit.study",
    "identify": "contact.identification",
    "load_case": "cases.case",
    "load_setup": "analyses.hopkinson.build",
    "load_solution": "analyses.machine.result",
    "map": "studies.map.study",
    "material": "base.constants",
    "materials": "base.constants",
    "read_record": "records.readers",
    "record": "analyses.record.examine",
    "run_case": "analyses.machine.run",
    "run_fem": "analyses.fem.run",
    "run_hopkinson": "analyses.hopkinson.run",
    "run_wave": "analyses.wave.run",
    "scatter": "studies.scatter.study",
    "settings": "studies.search.rotary",
    "shock_spectra": "analyses.record.file_spectra",
    "solve_impact": "contact.impact",
    "srs": "signal.srs",
    "sweep": "studies.sweep.study",
    "synthesize": "analyses.record.specification.synthesis",
}
"""Modules of the public names. A test holds this table and the imports above equal."""

__all__ = ["__version__", *(name for name in _HOMES if name != "map")]  # noqa: PLE0604  (the names stand once, above)
"""The public names but ``map``: a star import shall not hide Python's own."""


def __dir__() -> list[str]:
    """List the public names."""
    return sorted([*__all__, "map"])


if not TYPE_CHECKING:  # else a misspelled name would pass type checkers

    def __getattr__(name: str) -> Any:
        """Import a public name when it is first used (PEP 562)."""
        if name in _HOMES:
            return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
        raise AttributeError(f"module 'strikewave' has no attribute {name!r}")
