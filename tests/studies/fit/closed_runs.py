"""Runs in closed form, and what is measured of them: the case, numbers, pulses, problems."""

import numpy as np

from strikewave import load_case
from strikewave.analyses.compare.agreement import ComparedCurve
from strikewave.base.result import Verdict
from strikewave.signal.alignment import EvenHistory
from strikewave.signal.pulse import Pulse
from strikewave.studies.fit.free_fields import free_fields
from strikewave.studies.fit.measured import MeasuredNumber, MeasuredPulse
from strikewave.studies.fit.problem import Experiment, Problem

DROP = "jesd22-b111-b"
FORCE, LOSS, HEIGHT = "contact.reference_force", "contact.restitution", "machine.height"
TIME = np.arange(400) * 1e-6
CASE = load_case(DROP, [f"{LOSS}=0.7"])
NUMBERS = {"first.rigid_peak": ("m/s^2", 14000.0), "first.width": ("s", 5e-4)}
"""With their values for the case as it stands."""


class Closed:
    """A run whose peak goes with the root of height times force, and whose width with the inverse root of the force."""

    def __init__(self, case):
        self.case, self.verdict = case, Verdict.of([])

    @property
    def factors(self):
        values = self.case.values()
        return tuple(values[path].si / CASE.values()[path].si for path in (FORCE, LOSS, HEIGHT))

    def number(self, name, sensor=""):
        force, loss, height = self.factors
        return {
            "first.rigid_peak": 14000.0 * (force * height) ** 0.5 * loss**0.2,
            "first.width": 5e-4 * force**-0.5 * loss**0.3,
        }.get(name)

    def history(self, part, blow=0, unit=""):
        force, _, height = self.factors
        values = 14000.0 * (force * height) ** 0.5 * np.exp(-0.5 * ((TIME - 2e-4) / (2e-5 * force**-0.5)) ** 2)
        return ComparedCurve("case:board@1", "simulation", EvenHistory(values, 1e-6, 0.0), "m/s^2")


def number(name, share=0.0, uncertain=0.01, **more):
    unit, value = NUMBERS[name]
    value *= 1.0 + share
    return MeasuredNumber(name, "", unit, value, uncertain * value, f"{value}", **more)


def pulse(amplitude=1.0, noise=0.0, seed=1, name="a.csv", **more):
    """Return the pulse of the case as it stands on a record of its own, with white noise of a share of its peak."""
    values = amplitude * Closed(CASE).history("").history.values[80:321]
    values = values + noise * 14000.0 * np.random.default_rng(seed).standard_normal(values.size)
    record = ComparedCurve(
        name,
        "record",
        EvenHistory(values, 1e-6, 0.0),
        "m/s^2",
        measured=Pulse(1.2e-4, 14000.0 * amplitude, 8.5e-5, 3e-5, 0.7 * amplitude),
    )
    kept = slice(40, 201)
    known = {"quiet": 400} if noise else {"quiet": 0}
    return MeasuredPulse(
        record,
        "board",
        0,
        TIME[:241][kept],
        values[kept],
        max(noise, 1e-4) * 14000.0,
        correlation=np.ones(1),
        shot=name,
        **known,
        **more,
    )


def problem(*measured, free=(FORCE,), case=CASE, changes=()):
    return Problem([Experiment(case, changes, measured)], free_fields(case, free), Closed)
