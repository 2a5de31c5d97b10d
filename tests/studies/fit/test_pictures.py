"""What the pictures of a fit show: positions of lines and bands, limits, names, and their places on the sheet."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from strikewave.base.result import Verdicts
from strikewave.reporting.style import HALF, WHOLE
from strikewave.studies.fit import figures
from strikewave.studies.fit.estimation import ProfileEnds
from strikewave.studies.fit.free_fields import free_fields
from strikewave.studies.fit.measured import LaidPulse
from strikewave.studies.fit.posterior import Posterior
from strikewave.studies.fit.result import FittedParameter

from .closed_runs import CASE, FORCE, HEIGHT, LOSS, pulse

G = 9.80665


def laid_pulses(*spans):
    """Records of straight lines with the run above them, from 3 ms on, each over so many seconds."""
    found = []
    for k, span in enumerate(spans):
        time = 3e-3 + np.linspace(0.0, span, 5)
        measured = G * (k + np.arange(5.0))
        found.append((replace(pulse(name="abc"[k]), quiet=0), LaidPulse(time, measured, measured + G * (k + 0.5), 0.0)))
    return found


def test_records_are_drawn_over_one_another_from_their_begin_in_the_unit_of_the_longest():
    """Over 0.5 and 40 ms: in ms, each from 0 on; of three records one is named, of two both."""
    pairs = laid_pulses(5e-4, 0.04, 2e-3)
    bands = [(laid.computed - 2.0 * G, laid.computed + (3.0 + k) * G) for k, (_, laid) in enumerate(pairs[:2])]
    axes = Figure().subplots()
    figures.draw_overlay(axes, pairs, bands)
    lines = axes.lines
    assert [line.get_xdata()[-1] for line in lines] == pytest.approx([0.5, 0.5, 40.0, 40.0, 2.0, 2.0])
    assert [line.get_xdata()[0] for line in lines] == [0.0] * 6
    assert [line.get_ydata()[0] for line in lines] == pytest.approx([0.0, 0.5, 1.0, 2.5, 2.0, 4.5])
    named = [line.get_label() for line in lines]
    assert named[:2] == ["a", "fitted run"]
    assert all(name.startswith("_") for name in named[2:])
    ends = [one.get_paths()[0].get_extents() for one in axes.collections]
    assert [(one.x1, one.y0, one.y1) for one in ends] == [
        pytest.approx((0.5, -1.5, 7.5)),
        pytest.approx((40.0, 0.5, 10.5)),
    ]
    assert [one.get_label().startswith("95 %") for one in axes.collections] == [True, False]
    assert axes.get_xlabel() == "time from the beginning of what is fitted (ms)"
    assert axes.get_ylabel() == "acceleration (g)"
    two = Figure().subplots()
    figures.draw_overlay(two, laid_pulses(5e-4, 1e-4))
    assert [line.get_label() for line in two.lines[::2]] == ["a", "b"]
    long = Figure().subplots()
    ((one, laid),) = laid_pulses(1e-3)
    figures.draw_overlay(long, [(replace(one, record=replace(one.record, name="x" * 61)), laid)])
    assert len(long.lines[0].get_label()) == 60


def test_what_is_left_of_records_is_drawn_without_a_band_where_no_noise_is_known():
    """0.5, 1.5 and 2.5 g above them; the line of nothing left; time in ms of the longest."""
    pairs = laid_pulses(5e-4, 0.04, 2e-3)
    axes = Figure().subplots()
    figures.draw_residual(axes, pairs)
    assert not axes.patches
    assert [line.get_ydata()[0] for line in axes.lines] == pytest.approx([0.5, 1.5, 2.5, 0.0])
    assert [line.get_xdata()[-1] for line in axes.lines[:3]] == pytest.approx([0.5, 40.0, 2.0])
    assert axes.get_xlabel() == "time (ms)"
    assert axes.get_ylabel() == "acceleration (g)"


def study_of(*values, pulses=(), profiles=()):
    """What pictures take of a study: force, height and restitution with intervals, as shares of their bounds."""
    fields = free_fields(CASE, (FORCE, HEIGHT, LOSS)[: len(values)])
    parameters = tuple(
        FittedParameter(field, field.si(at), error, field.si(at - 0.1), field.si(at + 0.2), profile)
        for field, (at, error), profile in zip(fields, values, profiles or [None] * len(values), strict=True)
    )
    return SimpleNamespace(
        parameters=parameters,
        pulses=tuple(pulses),
        bands=(),
        verdicts=Verdicts((), "fitted runs"),
        solved=SimpleNamespace(estimate=SimpleNamespace(reach=np.array([1.96, 2.5, 3.5])[: len(values)])),
        title="three values",
    )


def test_values_stand_in_rows_the_first_above_each_between_its_bounds():
    study = study_of((0.4, 1.0), (0.3, np.inf), (0.6, 1.0))
    sheet = figures.values_figure(study)
    assert sheet.get_size_inches() == pytest.approx([WHOLE[0], 1.2 + 3 * 0.45])
    (axes,) = sheet.axes
    rows = [axes.lines[k : k + 4] for k in range(0, 12, 4)]
    assert [row[0].get_ydata()[0] for row in rows] == [2.0, 1.0, 0.0]
    for row, at, one in zip(rows, (0.4, 0.3, 0.6), study.parameters, strict=True):
        bounds, interval, value, start = row
        assert list(bounds.get_xdata()) == [0.0, 1.0]
        assert list(interval.get_xdata()) == pytest.approx([at - 0.1, at + 0.2])
        assert value.get_xdata()[0] == pytest.approx(at)
        assert start.get_xdata()[0] == pytest.approx(one.field.place(one.field.value.si))
        assert [line.get_ydata()[-1] for line in row] == [bounds.get_ydata()[0]] * 4
        assert value.get_markersize() < start.get_markersize() == 12
        assert value.get_markersize() == 6
    assert len({row[1].get_color() for row in rows}) == 2
    assert [text.get_text() for text in axes.get_yticklabels()] == ["reference force", "height", "restitution"]
    assert list(axes.get_yticks()) == [2.0, 1.0, 0.0]
    assert list(axes.get_xticks()) == [0.0, 1.0]
    assert axes.get_ylim() == pytest.approx((-0.6, 2.6))


def heights_of(sheet):
    """Return rows of the grid that each diagram covers, and the shares of their heights."""
    specs = [axes.get_subplotspec() for axes in sheet.axes]
    grid = specs[0].get_gridspec()
    assert grid.ncols == 1
    return grid.nrows, [one.rowspan.start for one in specs], list(grid.get_height_ratios())


def test_a_sheet_has_records_above_what_is_left_of_them_above_the_values():
    study = study_of((0.4, 1.0), (0.3, 1.0), pulses=laid_pulses(1e-3))
    sheet = figures.fit_figure(study)
    assert heights_of(sheet) == (3, [0, 1, 2], pytest.approx([1.6, 1.0, 0.84]))
    assert sheet.get_size_inches() == pytest.approx([WHOLE[0], 2.3 * 3.44])
    sheet = figures.overlay(study)
    assert heights_of(sheet) == (2, [0, 1], pytest.approx([1.6, 1.0]))
    assert sheet.get_size_inches() == pytest.approx([WHOLE[0], 6.0])
    assert heights_of(figures.fit_figure(study_of((0.4, 1.0))))[:2] == (1, [0])
    many = figures.overlay(study_of((0.4, 1.0), pulses=laid_pulses(1e-3) * 8))
    assert len(many.axes[0].lines) == 12  # of six records


def test_a_profile_is_drawn_in_the_unit_of_its_value_up_to_its_reach():
    """Rise of both sides upwards, the interval of the second value ends at 2.5 standard errors; the first has none."""
    ends = ProfileEnds(0.2, 0.6, np.array([0.2, 0.4, 0.6]), np.array([-2.5, 0.0, 2.0]))
    study = study_of((0.4, 1.0), (0.4, 1.0), profiles=(None, ends))
    ((sheet, _),) = figures.profile_figures(study)
    assert sheet.get_size_inches() == pytest.approx(HALF)
    (axes,) = sheet.axes
    curve, line = axes.lines
    field = study.parameters[1].field
    assert curve.get_xdata() == pytest.approx([field.si(at) for at in (0.2, 0.4, 0.6)])
    assert curve.get_ydata() == pytest.approx([2.5, 0.0, 2.0])
    assert curve.get_markersize() == 4
    assert line.get_ydata()[0] == 2.5
    assert axes.get_xlabel() == "value (m)"


class Recorder:
    """Stands for a diagram, and keeps what it is asked to draw."""

    def __init__(self):
        self.asked = {}

    def __getattr__(self, name):
        return lambda *words, **more: self.asked.setdefault(name, []).append((words, more))


@pytest.mark.parametrize(("count", "step"), [(1199, 1), (1200, 2), (1801, 3)])
def test_of_a_pair_600_draws_and_the_densest_68_and_95_percent_are_shown(count, step):
    """Middles of 24 bins from a tenth before to a tenth after all but 0.4 % of the draws; y runs along the rows."""
    rng = np.random.default_rng(3)
    x = rng.standard_normal(count)
    y = 10.0 + 3.0 * rng.standard_normal(count) + 2.0 * x
    axes = Recorder()
    figures._draw_pair(axes, x, y)
    (((across, up, density), how),) = axes.asked["contour"]
    for middles, values in ((across, x), (up, y)):
        low, high = np.quantile(values, [0.002, 0.998])
        low, high = low - 0.1 * (high - low), high + 0.1 * (high - low)
        assert middles == pytest.approx(low + (np.arange(24) + 0.5) * (high - low) / 24.0, rel=1e-9)
    mean = [np.sum(density * one) / density.sum() for one in (across[None, :], up[:, None])]
    assert mean == pytest.approx([x.mean(), y.mean()], abs=0.1)
    tilt = np.sum(density * (across[None, :] - mean[0]) * (up[:, None] - mean[1]))
    assert tilt > 0.0
    wide, dense = how["levels"]
    falling = np.sort(density.ravel())[::-1]
    for level, mass in ((wide, 0.95), (dense, 0.68)):  # the last bin that is needed is the level
        inside = falling[falling >= level].sum() / falling.sum()
        assert inside >= mass > inside - level / falling.sum()
    (((dots, heights), look),) = axes.asked["scatter"]
    assert dots == pytest.approx(x[::step])
    assert heights == pytest.approx(y[::step])
    assert look["s"] == 2


@pytest.mark.parametrize("count", [6, 3])
def test_a_corner_has_a_panel_of_each_value_and_pair_of_five_values_at_most(monkeypatch, count):
    """Histograms on the diagonal; the pair of row and column below it; named at the left and at the bottom."""
    asked = []
    monkeypatch.setattr(figures, "_draw_value", lambda axes, draws, fitted: asked.append((draws, fitted)))
    monkeypatch.setattr(figures, "_draw_pair", lambda axes, x, y: asked.append((x, y)))
    paths = [FORCE, HEIGHT, LOSS, "striker.mass", "object.mass", "contact.reference_depth"][:count]
    fields = free_fields(CASE, paths)
    parameters = [FittedParameter(one, one.si(0.3 + 0.05 * k), 1.0, 0.0, 1.0) for k, one in enumerate(fields)]
    draws = np.linspace(0.2, 0.8, 7)[:, None] * np.linspace(0.5, 1.0, count)
    figure = figures.corner_figure(SimpleNamespace(parameters=parameters, posterior=Posterior(draws, 9, 1.0, 0.5, 1)))
    size = min(count, 5)
    assert figure.get_size_inches() == pytest.approx([WHOLE[0], {5: 9.0, 3: 8.2}[size]])
    shown = [[one.field.axis.shown(one.field.si(at)) for at in draws[:, k]] for k, one in enumerate(parameters)]
    fitted = [one.field.axis.shown(one.value) for one in parameters]
    panels = np.array(figure.axes).reshape(size, size)
    for row in range(size):
        for column in range(size):
            axes = panels[row, column]
            assert axes.get_visible() == (column <= row)
            if column > row:
                continue
            first, second = asked.pop(0)
            assert first == pytest.approx(shown[column])
            assert second == pytest.approx(fitted[row] if row == column else shown[row])
            assert axes.get_xlim() == pytest.approx(figures._range(np.array(shown[column])))
            if row != column:
                assert axes.get_ylim() == pytest.approx(figures._range(np.array(shown[row])))
                ((x, y),) = [line.get_xydata()[0] for line in axes.lines]
                assert (x, y) == pytest.approx((fitted[column], fitted[row]))
                assert axes.lines[0].get_markersize() == 10
            words = [path.rpartition(".")[2].replace("_", " ") for path in (paths[column], paths[row])]
            below, left = row == size - 1, column == 0 < row
            assert axes.get_xlabel().partition(" (")[0] == (words[0] if below else "")
            assert axes.get_ylabel().partition(" (")[0] == (words[1] if left else "")
            assert axes.xaxis.get_tick_params()["labelbottom"] == below
            assert axes.yaxis.get_tick_params()["labelleft"] == (left or row == column)
            assert (axes.xaxis.label.get_fontsize() == 8.0) or not below
            assert (axes.yaxis.label.get_fontsize() == 8.0) or not left
            assert axes.xaxis.get_tick_params()["labelsize"] == 7
            assert axes.xaxis.get_major_locator()._nbins == 4
    assert not asked


def test_few_draws_have_contours_too():
    axes = Recorder()
    figures._draw_pair(axes, np.arange(5.0), np.array([0.0, 3.0, 1.0, 4.0, 2.0]))
    ((_, how),) = axes.asked["contour"]
    assert 0.0 < how["levels"][0] < 0.01
