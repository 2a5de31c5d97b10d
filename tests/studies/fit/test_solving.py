"""A whole fit of a run in closed form: its solution, what is left, advice, checks, choices, posterior, words and pictures."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave import load_case
from strikewave.base.errors import InputError
from strikewave.studies.engine.case_evaluation import numbers_of
from strikewave.studies.fit.checking import TriedChoice, allowed_places, check, drawn_places, tried
from strikewave.studies.fit.covariance import Estimate, Excess
from strikewave.studies.fit.free_fields import free_fields
from strikewave.studies.fit.measured import MeasuredNumber
from strikewave.studies.fit.posterior import Posterior, adjustment, log_likelihood, widened
from strikewave.studies.fit.problem import (
    Experiment,
    Problem,
    _check_felt,
    _nearest,
    _others,
    more_than_noise,
    separating,
    solve,
)
from strikewave.studies.fit.result import FittedParameter, combination_words, separating_words

from .closed_runs import CASE, FORCE, HEIGHT, LOSS, Closed, number, problem, pulse


def test_a_peak_in_closed_form_is_solved_with_its_error():
    """Peak goes with the root of the force: 1 % of it is 2 % of the force, of a range of two decades log(100)."""
    begun = problem(number("first.rigid_peak", 0.1))
    found = solve(begun)
    field = begun.fields[0]
    assert field.si(found.estimate.place[0]) == pytest.approx(1.21 * field.value.si, rel=1e-6)
    assert found.estimate.errors[0] == pytest.approx(0.02 / np.log(100.0), rel=1e-4)
    assert found.misfits[0].size == pytest.approx(0.0, abs=1e-5)
    assert not found.stopped
    assert found.others == ()
    assert found.runs == found.search.runs > 10


def test_what_is_left_of_numbers_is_in_their_uncertainties_and_shares():
    """Two peaks 3 % above and below the run, sure to 1 %: three uncertainties each; a record twice its noise."""
    measured = number("first.rigid_peak", 0.03), number("first.rigid_peak", -0.03, left=2.0)
    one = problem(*measured)
    residuals = one.residuals(one.start)
    assert residuals == pytest.approx([-3.0 / 1.03, 0.5 * 3.0 / 0.97], rel=1e-9)
    above, below = one.misfits(residuals)
    assert (above.size, below.size) == (pytest.approx(3.0 / 1.03), pytest.approx(3.0 / 0.97))
    assert (above.share, below.share) == (pytest.approx(0.03 / 1.03), pytest.approx(0.03 / 0.97))
    assert (above.independent, above.more_than_noise, above.is_number, above.scatters) == (1.0, False, True, False)
    assert not one.explained(residuals)
    assert one.explained(np.array([1.0, 0.49]))
    assert not one.explained(np.array([1.0, 0.51]))


def test_noise_is_told_from_more_by_its_quantile():
    """White noise of 161 samples, one taken by laying, beside 400 quiet ones: F of 160 and 400 at 0.999."""
    from scipy.stats import f, norm

    one = pulse(noise=0.01)
    limit = np.sqrt(f.isf(1e-3, 160, 400))
    for scatter in (0.0, 0.02):
        told = replace(one, scatter=scatter)
        amplitude = norm.isf(0.5e-3) * scatter * np.sqrt(np.mean(one.values**2)) / one.deviation
        edge = np.hypot(limit, amplitude)
        for size, more in ((0.999, False), (1.001, True)):
            left = np.full(161, size * edge)
            assert more_than_noise(told, left) == more
            assert more_than_noise(replace(told, left=2.0), 0.5 * left) == more
    slow = replace(one, correlation=0.5 ** np.arange(30))  # 0.6 of the samples are independent
    edge = np.sqrt(f.isf(1e-3, 161 * 0.6 - 1.0, 400 * 0.6))
    assert [more_than_noise(slow, np.full(161, size * edge)) for size in (0.999, 1.001)] == [False, True]
    silent = replace(one, quiet=0)
    edge = np.sqrt(f.isf(1e-3, 160, 1e9))
    assert [more_than_noise(silent, np.full(161, size * edge)) for size in (0.999, 1.001)] == [False, True]


def test_a_record_of_another_amplitude_is_fitted_alone_and_scatters():
    """Two records 2 % of amplitude apart: none at its best is noise, each alone is, by its slopes."""
    one = problem(pulse(1.02, 0.002, 1), pulse(0.98, 0.002, 2, "b.csv"), free=(FORCE, HEIGHT))
    residuals = one.residuals(one.start)
    jacobian = np.column_stack(
        [(one.residuals(one.start + d) - one.residuals(one.start - d)) / 2e-4 for d in 1e-4 * np.eye(2)]
    )
    alone = one.alone(residuals, jacobian)
    for rows, found in zip(one.rows(), one.misfits(residuals, alone), strict=True):
        part = jacobian[rows]
        assert part.T @ alone[rows] == pytest.approx(np.zeros(2), abs=1e-6 * np.linalg.norm(part) ** 2)
        left = np.sqrt(np.mean(residuals[rows] ** 2))
        assert found.size == pytest.approx(left)
        assert found.share == pytest.approx(
            left
            * 0.002
            * 14000.0
            / np.abs(one.measured[0].values if "a" in found.called else one.measured[1].values).max()
        )
        assert (found.independent, found.more_than_noise, found.scatters, found.noise_known) == (
            160.0,
            True,
            True,
            True,
        )
    first, second = one.blocks(residuals, jacobian)
    assert (first.rows, second.rows) == (slice(0, 161), slice(161, 322))
    assert (first.shot, second.shot, first.quiet, first.left) == (0, 1, 400.0, None)
    assert first.noise.tolist() == [1.0]
    heavier = one.weighted(one.misfits(residuals), Excess())
    shares = np.sqrt(np.mean([misfit.share**2 for misfit in one.misfits(residuals)]))
    for before, after in zip(one.measured, heavier.measured, strict=True):
        assert after.left == pytest.approx(shares * np.abs(before.values).max() / before.deviation)
    assert heavier.blocks(residuals, jacobian)[0].noise[0] == pytest.approx(1.0 / heavier.measured[0].left ** 2)


def test_repeats_at_settings_make_the_groups_of_the_excess():
    """Two settings with two peaks each and what is known of the force: 4 degrees less 2 within, groups by setting."""
    known = MeasuredNumber(FORCE, "", "N", 789.6e3, 1e3, "", of_field=True)
    peaks = [number("first.rigid_peak", share) for share in (0.5, 0.4, -0.5, -0.4)]
    one = Problem(
        [Experiment(CASE, (), (*peaks[:2], known, pulse())), Experiment(CASE, ("a",), tuple(peaks[2:]))],
        free_fields(CASE, [FORCE]),
        Closed,
    )
    residuals = np.concatenate([[10.0, -10.0, 3.0], np.zeros(161), [14.0, -14.0]])
    found = one.excess_of(residuals)
    assert found.within == pytest.approx(np.sqrt((200.0 + 392.0) / 2.0))
    assert one.shots() == [0, 1, None, 0, 2, 3]
    assert one.shot_count == 4
    assert one.excess_of(residuals * 1e-3) == Excess()
    met = problem(number("first.rigid_peak"), number("first.width"), free=(FORCE, LOSS))
    assert met.excess_of(np.array([50.0, 50.0])) == Excess()
    heavier = one.weighted(one.misfits(residuals), Excess(2.0, 3.0))
    weight = np.sqrt(4.0 + 2.0 * 9.0)
    assert [each.left for each in heavier.measured[:3]] == [pytest.approx(weight), pytest.approx(weight), 1.0]
    pooled = Problem(one.experiments, one.fields, Closed, Excess(2.0, 3.0, 10.0)).blocks(residuals, np.ones((166, 1)))
    assert [block.quiet for block in pooled if block.pooled] == [2.0] * 5


def test_numbers_beyond_their_uncertainties_widen_the_errors():
    """A force by three settings whose peaks lie 2 % apart, sure to 0.2 %: the error is that of their scatter, over sqrt(3)."""
    shares = np.array([-0.02, 0.0, 0.02])
    tests = [Experiment(CASE, (str(k),), (number("first.rigid_peak", share, 0.002),)) for k, share in enumerate(shares)]
    found = solve(Problem(tests, free_fields(CASE, [FORCE]), Closed))
    assert found.problem.excess.between == pytest.approx(10.0, rel=0.02)
    assert found.problem.excess.freedom == 2.0
    assert found.estimate.errors[0] * np.log(100.0) == pytest.approx(2.0 * 0.02 / np.sqrt(3.0), rel=0.02)


def test_a_stated_scatter_moves_the_best_place_by_refits():
    """Of a record whose amplitude scatters by 2 %, height and force free: the amplitude is of the height alone, twice that."""
    one = problem(pulse(1.0, 0.001, scatter=0.02), free=(FORCE, HEIGHT))
    found = solve(one)
    # refits to 0.96 and 1.04 of the record, two deviations away, move the height by twice the logarithm exactly
    moves = 2.0 * np.log([0.96, 1.04]) / np.log(100.0) / 2.0
    assert found.estimate.stated[1] == pytest.approx(np.mean(np.square(moves)), rel=1e-3)
    assert found.estimate.mostly_stated(1)


def test_of_ends_that_fit_alike_the_nearest_to_the_start_is_taken():
    """Sums of squares within 1 % and 0.01 of the least are alike."""
    ends = [(np.array([at]), np.array([np.sqrt(misfit)])) for at, misfit in ((0.9, 100.0), (0.5, 101.0), (0.1, 101.02))]
    assert _nearest(ends, np.array([0.0]))[0] == pytest.approx([0.5])
    assert _nearest(ends, np.array([1.0]))[0] == pytest.approx([0.9])


def test_other_solutions_fit_within_chance_and_lie_apart_along_what_is_determined():
    """Rise below 1.96^2 of a misfit of 4 in 2 residuals, so 7.68; ten errors of 0.01 apart, not along what is not known."""
    lost = np.array([[0.0], [1.0]])
    base = np.array([2.0, 0.0])
    found = Estimate(np.array([0.5, 0.5]), base, np.eye(2), np.diag([1e-4, 0.0]), lost, np.full(2, 1.96))
    places = {"near": (0.59, 0.9), "apart": (0.61, 0.5), "along": (0.5, 0.9)}
    for limit, kept in ((7.6, True), (7.8, False)):
        ends = [(np.array(place), np.array([np.sqrt(4.0 + limit), 0.0])) for place in places.values()]
        others = _others(ends, found, base)
        assert [one.tolist() for one in others] == ([[0.61, 0.5]] if kept else [])
    for rise, count in ((3.83, 1), (3.85, 0)):  # a misfit below one a residual counts as one
        ends = [(np.array([0.61, 0.5]), np.array([np.sqrt(0.02 + rise), 0.0]))]
        assert len(_others(ends, found, np.array([0.1, 0.1]))) == count


def test_drawn_places_have_the_covariance_and_are_even_where_nothing_is_known():
    """32 draws of a latin hypercube: their deviations within a fifth; along a lost direction from bound to bound."""
    found = Estimate(
        np.array([0.5, 0.4]), np.zeros(1), np.eye(2), np.diag([0.03**2, 0.01**2]), np.zeros((2, 0)), np.full(2, 1.96)
    )
    draws = np.array(drawn_places(found))
    assert draws.shape == (32, 2)
    assert np.std(draws, axis=0) == pytest.approx([0.03, 0.01], rel=0.2)
    assert np.mean(draws, axis=0) == pytest.approx([0.5, 0.4], abs=0.002)
    lost = np.array([[0.6], [0.8]])
    draws = np.array(drawn_places(replace(found, covariance=np.zeros((2, 2)), undetermined=lost)))
    along = (draws - found.place) @ lost[:, 0]
    assert (draws - found.place) @ np.array([0.8, -0.6]) == pytest.approx(np.zeros(32), abs=1e-12)
    assert np.sort(along) == pytest.approx(-0.5 + (np.arange(32) + 0.5) / 32 * (0.75 + 0.5), abs=0.5 / 32 * 1.25 + 1e-9)


def test_drawn_places_that_fit_worse_than_95_percent_are_halved_towards_the_best():
    """chi-squared of two at 5 % is 5.99 of a rise (x/0.1)^2: 0.2447 stands, 0.3 is halved once, 0.49 twice to 0.1225."""
    slopes = np.diag([10.0, 0.0])
    found = Estimate(
        np.full(2, 0.5), np.zeros(2), slopes, np.diag([0.01, 0.0]), np.array([[0.0], [1.0]]), np.full(2, 1.96)
    )
    solved = SimpleNamespace(estimate=found, problem=SimpleNamespace(residuals=lambda place: slopes @ (place - 0.5)))
    for start, end in ((0.2440, 0.2440), (0.2455, 0.12275), (0.49, 0.1225 * 2.0)):
        (place,) = allowed_places(solved, [np.array([0.5 + start, 0.9])])
        assert place[0] - 0.5 == pytest.approx(end if end <= 0.2447 else end / 2.0)
    wide = SimpleNamespace(
        estimate=replace(found, covariance=np.diag([0.04, 0.0]), reach=np.full(2, 2.0 * 1.96)), problem=solved.problem
    )
    limit = np.sqrt(5.991 * 4.0 * 4.0) / 10.0  # four times the variance, and twice the reach
    assert limit > 0.5
    (place,) = allowed_places(wide, [np.array([0.99, 0.9])])
    assert place.tolist() == [0.99, 0.9]


def test_a_number_that_was_kept_out_is_predicted_in_its_band():
    """Fitted to a peak sure to 1 %, the next one is predicted to 1.96 times that and its own 0.5 %; 32 draws good to an eighth."""
    begun = problem(number("first.rigid_peak"))
    solved = solve(begun)
    kept = Experiment(CASE, (), (number("first.rigid_peak", 0.02, 0.005), number("first.width", -0.3, 0.005)))
    checks = _checked(solved, [kept])
    peak, width = checks.figures
    assert peak.predicted == pytest.approx(14000.0, rel=1e-6)
    assert peak.bias == pytest.approx(1.0 / 1.02 - 1.0, rel=1e-5)
    half = np.hypot(1.96 * 0.01, 1.96 * 0.005 / 1.0)
    assert (peak.high - peak.low) / 28000.0 == pytest.approx(half, rel=0.1)
    assert (peak.high + peak.low) / 2.0 == pytest.approx(14000.0, rel=1e-6)
    assert (peak.inside, width.inside, checks.inside) == (True, False, 1)
    assert checks.biases == {
        "first.rigid_peak": pytest.approx(peak.bias),
        "first.width": pytest.approx(1.0 / 0.7 - 1.0, rel=1e-5),
    }


def _checked(solved, experiments):
    """Check by runs in closed form, which a problem of what is kept out does not know of."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("strikewave.studies.fit.checking.Problem", lambda tests, fields: Problem(tests, fields, Closed))
        return check(solved, experiments)


def test_what_fitted_figures_were_off_is_in_the_band_of_others():
    """Three records 10 % apart: root mean square of their bias, by Student's t of three; scatter is stated."""
    from scipy.stats import t

    tests = [
        Experiment(CASE, (str(k),), (number("first.rigid_peak", share, 0.2),))
        for k, share in enumerate((-0.1, 0.0, 0.1))
    ]
    begun = Problem(tests, free_fields(CASE, [FORCE]), Closed)
    solved = solve(begun)
    (figure,) = _checked(solved, [Experiment(CASE, (), (number("first.rigid_peak", 0.0, 1e-6),))]).figures
    biases = [figure.predicted / (14000.0 * (1.0 + share)) - 1.0 for share in (-0.1, 0.0, 0.1)]
    left = t.ppf(0.975, 3) * np.sqrt(np.mean(np.square(biases)))
    half = (figure.high - figure.low) / 2.0 / figure.predicted
    assert half == pytest.approx(np.hypot(left, 1.96 * 0.2 / np.sqrt(3.0)), rel=0.06)


def test_a_number_separates_what_a_product_leaves_open():
    """Of height and force their product is known; a width to 1 % tells the force to 2 % and so the height to 2 %.

    Along (1, -1)/sqrt(2) of equal logarithms; at 1.25 times the height nothing changes of that.
    """
    begun = problem(number("first.rigid_peak"), free=(FORCE, HEIGHT))
    solved = solve(begun)
    assert solved.estimate.groups() == [[0, 1]]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("strikewave.studies.fit.problem.Simulation", Closed)
        rows = separating(solved)
    assert [one.number for one in rows] == ["first.width"]
    assert rows[0].group == (FORCE, HEIGHT)
    assert rows[0].errors == pytest.approx(np.full(2, 0.02 / np.log(100.0)), rel=1e-3)
    study = SimpleNamespace(
        solved=solved, separating=rows, parameters=[SimpleNamespace(field=one) for one in begun.fields]
    )
    words = combination_words(study, [0, 1])
    assert words == f"the data fix {FORCE} × {HEIGHT} (to 2.00 %), not {FORCE} and {HEIGHT}"
    assert (
        separating_words(study, [0, 1]) == f"first.width measured to 1 % would ({FORCE} to 2.0 % and {HEIGHT} to 2.0 %)"
    )
    assert separating_words(study, [0]) == "no other number of the blow would"
    assert combination_words(study, [1]) == f"the data do not determine {HEIGHT}"


def test_values_are_written_to_two_digits_of_their_errors():
    field = free_fields(CASE, [FORCE])[0]
    for value, error, words in (
        (789.6e3, 12.34e3, "790 ± 12 kN"),
        (789.6e3, 1.0e3, "789.6 ± 1.0 kN"),
        (789.64e3, 0.123e3, "789.64 ± 0.12 kN"),
        (789.64e3, 123.4e3, "790 ± 123 kN"),
        (789.64e3, np.inf, "789.6 kN (not determined)"),
        (789.64e3, 0.0, "789.64000 ± 0.00000 kN"),
    ):
        assert FittedParameter(field, value, error, 0.0, 1.0).words == words


def test_a_choice_is_ranked_by_records_that_each_fit_was_without():
    """Three peaks 10 % apart, of the mean of two others: 15, 0 and 15 % off, over 20 %; two of them have no such rank."""
    shares = (-0.1, 0.0, 0.1)
    tests = [Experiment(CASE, (str(k),), (number("first.rigid_peak", share, 0.2),)) for k, share in enumerate(shares)]
    solved = solve(Problem(tests, free_fields(CASE, [FORCE]), Closed))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("strikewave.studies.fit.checking.Problem", lambda left, fields: Problem(left, fields, Closed))
        row = tried("a=b", solved)
        two = tried("a=b", solve(Problem(tests[:2], free_fields(CASE, [FORCE]), Closed)))
    sizes = []
    for k in range(3):
        values, sure = 1.0 + np.delete(shares, k), 0.2 * (1.0 + np.delete(shares, k))
        mean = np.sum(values / sure**2) / np.sum(1.0 / sure**2)
        sizes.append((mean - 1.0 - shares[k]) / (0.2 * (1.0 + shares[k])))
    assert row.kept_out == pytest.approx(np.sqrt(np.mean(np.square(sizes))), rel=1e-4)
    assert row.misfit == pytest.approx(np.sqrt(np.mean([one.size**2 for one in solved.misfits])))
    assert row.rank == (False, row.kept_out)
    assert np.isnan(two.kept_out)
    assert two.rank == (False, two.misfit)
    assert TriedChoice("a", failure="b").rank[0]


def test_a_posterior_of_the_width_of_the_fit_has_its_likelihood():
    """At 2 standard errors of the fit along either axis, whatever covariance the slopes have, ln L = -2; Student's t wider."""
    slopes, best = np.array([[40.0, 5.0], [-12.0, 30.0], [8.0, 25.0]]), np.array([0.45, 0.55])
    covariance = np.array([[4e-4, 1e-4], [1e-4, 9e-4]])
    found = Estimate(best, np.zeros(3), slopes, covariance, np.zeros((2, 0)), np.array([1.96, 3.92]))
    wide = widened(found)
    assert wide == pytest.approx(covariance * np.array([[1.0, 2.0], [2.0, 4.0]]))
    likelihood = log_likelihood(lambda place: slopes @ (place - best), found)
    for vector in (np.array([0.02, 0.01]), np.array([-0.01, 0.03])):
        assert likelihood(best + vector) == pytest.approx(-0.5 * vector @ np.linalg.solve(wide, vector), rel=1e-9)
    lost = np.array([[0.6], [0.8]])
    along = adjustment(replace(found, undetermined=lost))
    assert along @ lost == pytest.approx(lost)


def test_chains_of_fifty_memories_and_two_thousand_draws_are_long_enough():
    """32 chains: of 100 steps of memory 1.6 there are 2000 draws."""
    draws = np.linspace(0.0, 1.0, 101)[:, None]
    chains = Posterior(draws, 100, 1.6, 0.5, 1)
    assert chains.independent == pytest.approx(2000.0)
    assert not chains.too_short
    assert replace(chains, memory=1.61).too_short
    assert not replace(chains, steps=1000, memory=15.9).too_short
    assert replace(chains, steps=1000, memory=20.1).too_short
    assert chains.quantiles(0.25) == pytest.approx([0.25])
    assert [float(one[0]) for one in chains.some(3)] == pytest.approx([0.0, 0.5, 1.0])
    assert len(chains.some(1000)) == 101


def wiggled(size, seed=3):
    """Return a pulse with a wave under it that no force follows."""
    one = pulse(1.0, 0.001, seed, "b.csv")
    along = np.linspace(0.0, 1.0, one.values.size)
    return replace(one, values=one.values + size * 14000.0 * np.sin(20.0 * np.pi * along) * np.sin(np.pi * along) ** 2)


def test_what_is_left_of_one_of_two_records_is_in_the_weights_of_both_and_of_one_alone_in_none():
    both = problem(pulse(1.0, 0.001), wiggled(0.02))
    weights = [one.left for one in solve(both).problem.measured]
    assert min(weights) > 5.0  # some 2 %/sqrt(5) over 0.1 %, root mean square of both
    for measured in ((wiggled(0.02),), (pulse(1.0, 0.001), pulse(1.0, 0.001, 4))):
        alone = problem(*measured)
        assert solve(alone).problem is alone
    close = [Experiment(CASE, (str(k),), (number("first.rigid_peak", k * 1e-5),)) for k in range(3)]
    alike = Problem(close, free_fields(CASE, [FORCE]), Closed)
    assert solve(alike).problem is alike


def test_an_error_holds_how_far_a_field_moves_until_the_run_feels_it(monkeypatch):
    """Anywhere within a tenth to either side: a third of its square besides; slopes over three of them, sinh(h/2)/(h/2)."""
    monkeypatch.setattr("strikewave.studies.fit.problem.stairs", lambda case, paths: [0.1])
    found = solve(problem(number("first.rigid_peak")))
    slope = np.sinh(0.15) / 0.15
    wanted = np.hypot(0.02 / slope, 0.1 / np.sqrt(3.0)) / np.log(100.0)
    assert found.estimate.errors[0] == pytest.approx(wanted, rel=1e-4)


def test_steps_of_a_field_are_the_largest_of_all_experiments_over_its_bounds(monkeypatch):
    """A tenth of 0.7 on bounds of 0.99; of a force on a logarithm of 100."""
    others = {0.7: [0.1, 0.02], 0.8: [0.05, 0.3]}
    cases = [CASE, CASE.with_values({LOSS: CASE.values()[LOSS].model_copy(update={"si": 0.8})})]
    monkeypatch.setattr("strikewave.studies.fit.problem.stairs", lambda case, paths: others[case.values()[LOSS].si])
    one = Problem([Experiment(case, (), ()) for case in cases], free_fields(CASE, [LOSS, FORCE]), Closed)
    assert one.stairs == pytest.approx([0.1 * 0.7 / 0.99, 0.3 / np.log(100.0)])


def test_of_fast_runs_the_full_ones_correct_the_end(monkeypatch):
    """Their peaks are 3 % high, by which the force is 6 % low where they end; what is asked for is the full one's."""

    class Fast(Closed):
        def number(self, name, sensor=""):
            return 1.03 * super().number(name)

    begun = problem(number("first.rigid_peak", 0.1))
    monkeypatch.setattr(begun, "fast", lambda: Problem(begun.experiments, begun.fields, Fast))
    found = solve(begun)
    assert begun.fields[0].si(found.estimate.place[0]) == pytest.approx(1.21 * 789.6e3, rel=1e-6)
    assert found.search.residuals == begun.residuals


def test_a_search_that_is_stopped_keeps_its_best_place():
    calls = []

    def advance(runs, misfit):
        calls.append(misfit)
        if len(calls) == 5:
            raise KeyboardInterrupt

    begun = problem(number("first.rigid_peak", 0.1))
    found = solve(begun, advance)
    assert found.stopped
    assert found.estimate.misfit == pytest.approx(calls[4])
    assert found.estimate.misfit < calls[0]


@pytest.mark.parametrize(
    ("sizes", "felt"), [((1.0, 1.1e-7), True), ((1.0, 0.9e-7), False), ((0.0, 0.0), False), ((1e-3, 1e-9), True)]
)
def test_a_field_is_felt_from_a_ten_millionth_of_the_largest_slope_on(sizes, felt):
    one = problem(free=(FORCE, LOSS))
    search = SimpleNamespace(slopes=lambda place, first, step: np.array([[0.6], [0.8]]) * np.array(sizes))
    if felt:
        _check_felt(one, search, np.zeros(2))
    else:
        with pytest.raises(InputError, match="a field that changes what was measured") as error:
            _check_felt(one, search, np.zeros(2))
        assert (LOSS if sizes[0] else FORCE) in str(error.value)


def test_other_solutions_lie_a_thousandth_of_the_bounds_apart_at_least():
    found = Estimate(np.array([0.5]), np.zeros(1), np.eye(1), np.zeros((1, 1)), np.zeros((1, 0)), np.full(1, 1.96))
    for apart, count in ((1.005e-3, 1), (0.995e-3, 0)):
        ends = [(np.array([0.5 + apart]), np.zeros(1))]
        assert len(_others(ends, found, np.zeros(1))) == count


def test_numbers_are_run_fast_and_records_or_other_numbers_are_not(monkeypatch):
    """A rotary machine and no stack: the numbers of its fast run, and what is known of a field."""
    case = load_case("li-ma-2019")
    fields = free_fields(case, ["machine.engagement"])
    names = numbers_of(case, "fast")
    fast = MeasuredNumber(next(iter(names)), "", "", 1.0, 0.1, "")
    known = MeasuredNumber("machine.engagement", "", "m", 1.0, 0.1, "", of_field=True)
    other = MeasuredNumber("first.no-such", "", "", 1.0, 0.1, "")
    monkeypatch.setattr("strikewave.studies.fit.problem.or_none", lambda function, item: 1.0)
    for case_of, measured, runs in (
        (case, (fast, known), True),
        (case, (fast, other), False),
        (case, (fast, pulse()), False),
        (CASE, (known,), False),
    ):
        found = Problem([Experiment(case_of, (), measured)], fields).fast()
        assert (found is not None) == runs
    one = Problem([Experiment(case, (), (fast,))], fields)
    monkeypatch.setattr("strikewave.studies.fit.problem.or_none", lambda function, item: None)
    assert one.fast() is None


def test_what_separates_values_is_the_same_at_their_bounds_whatever_else_is_known():
    """Powers have the same slopes everywhere; a loss that is known beside height and force takes no part."""
    known = MeasuredNumber(LOSS, "", "", 0.7, 1e-3, "0.7", of_field=True)
    solved = solve(problem(known, number("first.rigid_peak"), free=(LOSS, FORCE, HEIGHT)))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("strikewave.studies.fit.problem.Simulation", Closed)
        for at in (0.0, 0.5, 1.0):
            place = np.array([solved.estimate.place[0], at, at])
            moved = replace(solved, estimate=replace(solved.estimate, place=place))
            (row,) = separating(moved)
            assert (row.group, row.number) == ((FORCE, HEIGHT), "first.width")
            assert row.errors == pytest.approx(np.full(2, 0.02 / np.log(100.0)), rel=1e-3)
        assert separating(replace(moved, stopped=True)) == []


def test_of_two_ways_that_are_lost_no_number_tells_all():
    solved = solve(problem(number("first.rigid_peak"), free=(FORCE, HEIGHT, LOSS)))
    assert solved.estimate.undetermined.shape[1] == 2
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("strikewave.studies.fit.problem.Simulation", Closed)
        assert separating(solved) == []
    assert separating(solve(problem(number("first.rigid_peak")))) == []


def test_a_record_that_leaves_less_than_its_noise_has_its_weight():
    one = problem(pulse(1.0, 0.01))
    (left,) = one.misfits(one.residuals(one.start))
    told = replace(left, more_than_noise=True, share=1e-9)
    assert one.weighted([told], Excess()).measured[0].left == 1.0


def test_places_are_halved_each_by_what_it_fits_with_what_the_determined_add():
    """Two of three are known to twice what the slopes say: per one of these 4 of the misfit, so 31.3 where 7.8 is 95 %."""
    slopes = np.diag([20.0, 20.0, 0.0])
    covariance, lost = np.diag([0.01, 0.01, 0.0]), np.array([[0.0], [0.0], [1.0]])
    found = Estimate(np.full(3, 0.5), np.zeros(3), slopes, covariance, lost, np.full(3, 1.96))
    solved = SimpleNamespace(estimate=found, problem=SimpleNamespace(residuals=lambda place: slopes @ (place - 0.5)))
    limit = np.sqrt(7.8147 * 4.0) / 20.0
    moves = [np.array([share * limit, 0.0, 0.3]) for share in (0.99, 1.01, 0.5, 1.7)]
    places = allowed_places(solved, [0.5 + move for move in moves])
    wanted = [0.5 + move * half for move, half in zip(moves, (1.0, 0.5, 1.0, 0.5), strict=True)]
    assert np.array(places) == pytest.approx(np.array(wanted))


def test_all_experiments_must_run_fast(monkeypatch):
    monkeypatch.setattr("strikewave.studies.fit.problem.or_none", lambda function, item: 1.0)
    case = load_case("li-ma-2019")
    fields = free_fields(case, ["machine.engagement"])
    known = MeasuredNumber("machine.engagement", "", "m", 1.0, 0.1, "", of_field=True)
    tests = [Experiment(case, (), (known,)), Experiment(CASE, (), (known,))]
    assert Problem(tests[:1], fields).fast() is not None
    assert Problem(tests, fields).fast() is None
