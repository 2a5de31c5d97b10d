"""What the element models of the reproduction come to: whole bodies, slopes, the sensor; on coarse elements."""

import functools

import numpy as np
import pytest

from strikewave.analyses.fem.run import run_fem
from strikewave.cases.case import load_case
from strikewave.fem.run import interval_means, mean_force
from strikewave.papers.li_ma_2019.element_pulses import element_numbers, rise_slope, whole_force
from strikewave.papers.li_ma_2019.element_studies import NO_YIELD
from strikewave.papers.li_ma_2019.runs import (
    QUIET_ELEMENTS,
    QUIET_WAVE_ELEMENTS,
    RIGID_ELEMENTS,
    Effort,
    coarser,
    element_cases,
    quick_changes,
    within,
)


@functools.lru_cache
def coarse(name):
    """A case on elements four times as large, for its first 60 us."""
    return run_fem(load_case(name, [*coarser(load_case(name), 4.0), "fem.duration=60 us", "fem.frames=0"]))


def test_momentum_and_impulse_are_those_of_whole_bodies():
    """Four quarters; the free body takes all that the contact gives, but for its weight in 60 us."""
    solution = coarse(RIGID_ELEMENTS)
    numbers, name = element_numbers(solution), next(iter(solution.run.force))
    impulse = 4.0 * abs(solution.model_run.impulse[name][-1, 2])  # sideways the quarters cancel
    assert numbers.impulse == pytest.approx(impulse, rel=1e-12)
    assert numbers.peak_force == pytest.approx(
        4.0 * np.abs(mean_force(solution.model_run, name)[:, 2]).max(), rel=1e-12
    )
    weight = solution.run.groups["object"].mass * 9.8 * 60e-6
    assert numbers.momentum == pytest.approx(impulse, abs=weight + 1e-3 * impulse)


def test_the_early_slope_is_that_of_the_foot_and_the_late_one_that_below_the_top():
    solution = coarse(QUIET_ELEMENTS)
    numbers, (time, force, _) = element_numbers(solution), whole_force(solution)
    assert numbers.slope_early == rise_slope(time, force, (0.1, 0.3))
    assert numbers.slope_late == rise_slope(time, force, (0.5, 0.9))
    assert numbers.slope_early > 10.0 * numbers.slope_late, "the walls bend once the contact is closed"


def test_the_section_of_the_sensor_is_driven_the_way_of_the_blow():
    """Largest along the blow, downward; the mid section of a short disc moves much as its mean does."""
    solution = coarse(QUIET_WAVE_ELEMENTS)
    numbers, run = element_numbers(solution), solution.run
    along = interval_means(run.sections["sensor-middle"].velocity, run.time) @ np.array([0.0, 0.0, -1.0])
    assert numbers.section_peak == pytest.approx(along.max(), rel=1e-9)
    assert numbers.section_peak == pytest.approx(numbers.mean_peak, rel=0.05)


def test_nothing_yields_in_the_model_without_yield():
    solid = {
        part.name: part.solid.yield_strength for part in load_case(QUIET_ELEMENTS, NO_YIELD).mesh.part if part.solid
    }
    assert {name: strength and strength.si for name, strength in solid.items()} == {"striker": 1e11, "frame": 1e11}


def test_a_coarser_mesh_is_coarser_where_it_is_refined_too():
    assert coarser(load_case(RIGID_ELEMENTS), 2.0) == [
        "mesh.part.striker.size=6 mm",
        "mesh.part.striker.finest=1 mm",
        "mesh.part.frame.size=2 mm",
        "mesh.part.frame.finest=1 mm",
        "mesh.part.shell.size=1.5 mm",
    ]


def test_a_quick_run_changes_sizes_and_duration_alone():
    for case in element_cases(Effort(quick=True)):
        assert case == load_case(case.name, quick_changes(case.name))
        full, changed = load_case(case.name).values(), case.values()
        moved = {path for path, value in changed.items() if value.si != full[path].si}
        asked = {change.partition("=")[0] for change in quick_changes(case.name)}
        assert moved | {"fem.duration", "compare"} == asked, "the wave has 400 us anyway"


def test_a_stage_says_its_name_before_its_words():
    seen = []
    report = within(lambda share, words: seen.append((share, words)), 0.25, 0.75, "a case")
    report(0.5, "builds the mesh")
    report(1.0, "")
    within(lambda share, words: seen.append((share, words)), 0.0, 0.5)(0.5, "a study")
    assert seen == [(0.5, "a case: builds the mesh"), (0.75, "a case"), (0.25, "a study")]
