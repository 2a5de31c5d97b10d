"""The study of a fit of a run in closed form."""

import pytest

from strikewave.studies.fit.free_fields import free_fields
from strikewave.studies.fit.problem import Experiment, Problem
from strikewave.studies.fit.study import fitted_study
from strikewave.studies.fit.targets import ReadTargets

from .closed_runs import CASE, FORCE, Closed


@pytest.fixture
def studied(monkeypatch):
    """Return what makes the study of a fit of what was measured, run in closed form."""
    monkeypatch.setattr("strikewave.studies.fit.study.Problem", lambda tests, fields: Problem(tests, fields, Closed))
    monkeypatch.setattr("strikewave.studies.fit.problem.Simulation", Closed)
    monkeypatch.setattr("strikewave.studies.fit.study.speed_notices", lambda *words: ())

    def study(*measured, free=(FORCE,)):
        fields = free_fields(CASE, free)
        return fitted_study(CASE, fields, ReadTargets((Experiment(CASE, (), measured),), (), ()), [])

    return study
