"""Least squares in the unit cube, against pulses in closed form whose values and noise are planted."""

import numpy as np
import pytest
from scipy.signal import lfilter

from strikewave.studies.fit.covariance import Estimate, ResidualBlock, autocorrelation, estimate, independent_count
from strikewave.studies.fit.estimation import ACCURACY, FINAL_STEP, Search, is_quadratic, profile

TIME = np.linspace(-1.0, 1.0, 160)


def pulse(place):
    """A pulse of two values, height and width, each from a tenth to ten times 1 as its place goes from 0 to 1."""
    height, width = 10.0 ** (2.0 * np.asarray(place) - 1.0)
    return height * np.exp(-((TIME / (0.3 * width)) ** 2))


def coloured(rng, share, count):
    """Noise of deviation 1 with a correlation of ``share`` between neighbours."""
    noise = lfilter([np.sqrt(1.0 - share**2)], [1.0, -share], rng.standard_normal(count + 200))
    return noise[200:]


def fitted(residuals, blocks, start=(0.4, 0.6)):
    search = Search(residuals, len(start))
    search.begin(np.array(start))
    place, left = search.descend(np.array(start))
    return search, estimate(place, left, search.slopes(place, left, FINAL_STEP, both=True), blocks)


@pytest.mark.verify
@pytest.mark.parametrize("share", [0.0, 0.9])
def test_intervals_hold_planted_values_in_95_of_100_fits(share):
    """In white noise, and in noise of 20 samples' memory that weights know nothing of: 60 fits of 2 values each.

    The colour is that of 600 quiet samples, as of a record. Of 120 intervals of 95 %, 120 ± 2.4 standard deviations of
    chance give 108 to 119.
    """
    rng, inside = np.random.default_rng(20), 0
    for _ in range(60):
        truth, deviation = rng.uniform(0.4, 0.6, 2), 0.02
        measured = pulse(truth) + deviation * coloured(rng, share, TIME.size)
        colour = autocorrelation(coloured(rng, share, 600))
        block = [ResidualBlock(slice(0, TIME.size), colour, 0, quiet=independent_count(600, colour))]
        _, found = fitted(lambda place, m=measured, d=deviation: (pulse(place) - m) / d, block)
        assert not found.groups()
        inside += np.count_nonzero(np.abs(found.place - truth) < found.reach * found.errors)
    assert 108 <= inside <= 119


def test_slow_noise_beneath_white_noise_is_seldom_taken_for_much_less_than_it_is():
    """A fifth of the power has a memory of 33 samples, and 216 quiet samples show it: of 40 errors of the height of a
    pulse at most 20 are below 0.6 of the true one, as some can be whose six independent samples show nothing slow. The
    order of the least criterion alone leaves 55 of 100.
    """
    rng, shape, lags = np.random.default_rng(20), pulse([0.5, 0.5]), np.arange(TIME.size)
    apart = np.abs(lags[:, None] - lags)
    truth = shape @ (0.8 * np.eye(TIME.size) + 0.2 * 0.97**apart) @ shape
    low = 0
    for _ in range(40):
        noise = np.sqrt(0.8) * coloured(rng, 0.0, 216) + np.sqrt(0.2) * coloured(rng, 0.97, 216)
        known = np.append(np.var(noise) * autocorrelation(noise), np.zeros(TIME.size))[: TIME.size]
        low += shape @ known[apart] @ shape < 0.36 * truth
    assert low <= 20


@pytest.mark.parametrize("seed", range(8))
def test_values_that_only_their_product_fixes_are_named_and_no_other(seed):
    """Height = a b: a and b together are undetermined whatever the noise, the width is not."""
    rng = np.random.default_rng(seed)
    truth = rng.uniform(0.4, 0.6, 3)

    def model(place):
        return pulse([place[0] + place[1] - 0.5, place[2]])

    deviation = 10.0 ** rng.uniform(-4.0, -1.5)
    measured = model(truth) + deviation * rng.standard_normal(TIME.size)
    block = [ResidualBlock(slice(0, TIME.size), np.ones(1), 0)]
    _, found = fitted(lambda place: (model(place) - measured) / deviation, block, start=(0.4, 0.5, 0.6))
    assert found.groups() == [[0, 1]]
    assert np.isinf(found.errors[:2]).all()
    assert abs(found.place[2] - truth[2]) < 5.0 * found.errors[2]
    along = found.undetermined[:, 0] * np.sign(found.undetermined[0, 0])
    assert along == pytest.approx([np.sqrt(0.5), -np.sqrt(0.5), 0.0], abs=1e-3)


def test_a_value_that_nothing_was_measured_of_is_undetermined_alone():
    block = [ResidualBlock(slice(0, TIME.size), np.ones(1), 0)]
    measured = pulse([0.5, 0.5])
    _, found = fitted(lambda place: (pulse([place[0], 0.5]) - measured) / 0.01 + 0.0 * place[1], block)
    assert found.groups() == [[1]]


def test_a_profile_gives_the_interval_that_a_parabola_does_not():
    """One number, x^2 = 0.25: the ends solve (x^2 - 0.25)/u = ± 1.96 in closed form."""
    uncertainty = 0.1

    def residuals(place):
        return np.array([(place[0] ** 2 - 0.25) / uncertainty])

    search, found = fitted(residuals, [ResidualBlock(slice(0, 1), np.ones(1), 0)], start=(0.6,))
    assert not is_quadratic(search, found, 0)
    ends = profile(search, found, 0)
    assert [ends.low, ends.high] == pytest.approx(np.sqrt(0.25 + np.array([-1.96, 1.96]) * uncertainty), abs=3e-3)


def test_of_two_valleys_the_deeper_is_found():
    """100 (x - 0.2)^2 (x - 0.75)^2 + (x - 0.75)^2: a search from the shallow one stays there, several starts do not."""

    def residuals(place):
        return np.array([10.0 * (place[0] - 0.2) * (place[0] - 0.75), place[0] - 0.75, place[1] - 0.5])

    search, start = Search(residuals, 2), np.array([0.15, 0.4])
    search.begin(start)
    assert search.descend(start)[0][0] == pytest.approx(0.2, abs=0.03)
    assert search.wide(start)[0][0] == pytest.approx([0.75, 0.5], abs=1e-5)


def test_a_place_that_cannot_be_run_turns_the_search_back():
    """Half of the cube fails: the best place beside it is found from several starts, of which some fail."""

    def residuals(place):
        if place[0] > 0.55:
            raise ValueError("cannot be run")
        return np.append(10.0 * (place - 0.5), 0.1)

    search = Search(residuals, 2)
    search.begin(np.array([0.1, 0.9]))
    assert search.wide(np.array([0.1, 0.9]))[0][0] == pytest.approx([0.5, 0.5], abs=1e-6)


def test_colour_of_noise_is_found_from_few_samples():
    """Of an autoregression with 0.9, 600 samples: the independent ones, n (1 - a^2)/(1 + a^2) in closed form.

    One such record knows its own memory of 20 samples to a third; the median of 30 is below that.
    """
    counts = [
        independent_count(600, autocorrelation(coloured(np.random.default_rng(seed), 0.9, 600))) for seed in range(30)
    ]
    assert np.median(counts) == pytest.approx(600.0 * 0.19 / 1.81, rel=0.2)


def burg(noise):
    """Return the autoregression of each order, its power and criterion, by definition: errors over shifted copies."""
    x = noise - noise.mean()
    rows, weights = [(np.ones(1), np.mean(x**2))], np.ones(1)
    for order in range(1, x.size // 10 + 1):
        windows = np.lib.stride_tricks.sliding_window_view(x, order + 1)[:, ::-1]  # newest first
        longer = np.append(weights, 0.0)
        ahead, behind = windows @ longer, windows @ longer[::-1]
        share = -np.dot(ahead, behind) / np.mean([ahead @ ahead, behind @ behind])
        weights = longer + share * longer[::-1]
        rows.append((weights, rows[-1][1] * (1.0 - share) * (1.0 + share)))
    values = np.arange(1, len(rows) + 1)  # of each, with the power
    criteria = [x.size * np.log(power) for _, power in rows] + 2.0 * values * x.size / (x.size - values - 1.0)
    return rows, criteria


@pytest.mark.parametrize("count", [20, 29, 45, 60])
@pytest.mark.parametrize("share", [0.3, 0.8])
def test_colour_is_that_of_the_spectrum_of_the_slowest_autoregression_that_the_criterion_supports(count, share):
    """Autocorrelation by the inverse transform of its spectral density (Wiener & Khinchin), 1e-9 where no lag folds back.

    Within 8 of the least criterion of Akaike, corrected; the density at frequency 0 says which wanders most.
    """
    for seed in (*range(23), 40, 46, 53):  # of the last three the order hangs on the square of the sum of weights
        noise = coloured(np.random.default_rng(seed), share, count)
        rows, criteria = burg(noise)
        supported = [row for row, one in zip(rows, criteria, strict=True) if one <= criteria.min() + 8.0]
        weights, _ = max(supported, key=lambda row: row[1] / np.sum(row[0]) ** 2)
        lags = np.fft.irfft(1.0 / np.abs(np.fft.rfft(weights, 8192)) ** 2)
        lags /= lags[0]
        found = autocorrelation(noise)
        assert found == pytest.approx(lags[: found.size], abs=1e-9)
        assert np.abs(lags[found.size : 4096]).max() <= 1e-4 < abs(found[-1])


def test_noise_of_a_few_samples_or_of_none_is_taken_for_white():
    for noise in (np.zeros(50), np.array([1.0, 2.0]), np.arange(9.0)):
        assert autocorrelation(noise).tolist() == [1.0]


def test_colour_of_noise_is_followed_over_40_samples_and_no_more():
    """An echo of 0.9 after 30 samples is found, after 60 it is not."""
    for after, found in ((30, True), (60, False)):
        filtered = lfilter([1.0], [1.0, *np.zeros(after - 1), -0.9], np.random.default_rng(2).standard_normal(1500))
        colour = autocorrelation(filtered)
        assert (colour.size > after and colour[after] > 0.7) == found


def test_a_noise_of_correlation_a_has_one_and_a_squared_over_one_less_a_squared_fewer_samples():
    """The mean square of n samples with autocorrelation a^k is as sure as that of n (1 - a^2)/(1 + a^2)."""
    assert independent_count(700, 5.0 * 0.6 ** np.arange(80)) == pytest.approx(700.0 * 0.64 / 1.36, rel=1e-12)
    assert independent_count(10, np.ones(1)) == 10.0


def test_slopes_are_those_of_a_parabola_inside_and_at_either_end():
    """Of x^2 from both sides 2 x exactly, from one side 2 x and the step; beside a bound from within; none where all fail."""
    place = np.array([0.3, 1.0, 0.0])
    search = Search(lambda one: one**2, 3)
    middle = search.begin(place)
    single, both = (search.slopes(place, middle, 1e-3, both=one) for one in (False, True))
    assert single == pytest.approx(np.diag([0.601, 1.999, 0.001]), abs=1e-12)
    assert both == pytest.approx(np.diag([0.6, 1.999, 0.001]), abs=1e-12)

    def one_side(one):
        if abs(one[1] - 0.5) > 1e-9 or one[0] > 0.4:
            raise ValueError("cannot be run")
        return one**2

    edge = np.array([0.4, 0.5])
    search = Search(one_side, 2)
    found = search.slopes(edge, search.begin(edge), 1e-3, both=True)
    assert found == pytest.approx(np.array([[0.799, 0.0], [0.0, 0.0]]), abs=1e-12)


def test_slopes_are_taken_over_three_stairs():
    """Steps of 0.02 in a coordinate: from the middle of one, three to either side, whose slope is exact."""

    def stepped(place):
        return np.array([np.floor(place[0] / 0.02 + 1e-9), place[1] ** 2])

    search, place = Search(stepped, 2, stairs=np.array([0.02, 0.0])), np.array([0.51, 0.5])
    middle = search.begin(place)
    assert search.slopes(place, middle, 1e-3, both=True) == pytest.approx(np.diag([50.0, 1.0]), rel=1e-9)
    other = search.of_others(lambda one: 2.0 * stepped(one))
    assert other.runs == search.runs == 4
    assert other.slopes(place, 2.0 * middle, 1e-3) == pytest.approx(np.diag([100.0, 2.002]), rel=1e-9)


def test_a_search_counts_its_runs_keeps_its_best_and_asks_for_a_place_once():
    told = []
    search = Search(lambda place: place - 0.3, 1, lambda runs, misfit: told.append((runs, misfit)))
    search.begin(np.array([0.5]))
    search.many([np.array([0.9]), np.array([0.4])])
    assert search.best[0] == pytest.approx(0.01)
    assert search.best[1] == pytest.approx([0.4])
    assert search.at(np.array([0.8])) == pytest.approx([0.5])
    search.at(np.array([0.8]))
    assert search.runs == 3
    assert told == [(2, pytest.approx(0.01)), (3, pytest.approx(0.01))]
    search.residuals = lambda place: place
    assert search.best[0] == np.inf
    assert search.at(np.array([0.8])) == pytest.approx([0.8])  # nothing of the others is remembered


def test_a_place_that_cannot_be_run_is_ten_times_worse_than_the_first():
    def residuals(place):
        if place[0] > 0.5:
            raise ValueError("cannot be run")
        return np.array([-3.0, 0.5]) if place[0] < 0.3 else np.array([0.1, 0.2])

    for start, size in ((0.2, 30.0), (0.4, 10.0)):  # over 1 at least
        search = Search(residuals, 1)
        search.begin(np.array([start]))
        assert search.at(np.array([0.9])).tolist() == [size, size]


def test_only_free_coordinates_move_and_none_where_none_is_free():
    """x1 and x0 of one sum: with x0 held at 0.2 the other is at 0.7."""
    search = Search(lambda place: np.array([10.0 * (place[0] + place[1] - 0.9)]), 2)
    search.begin(np.array([0.2, 0.2]))
    place, left = search.descend(np.array([0.2, 0.2]), [1])
    assert place == pytest.approx([0.2, 0.7], abs=1e-6)
    assert left == pytest.approx([0.0], abs=1e-5)
    place, left = search.descend(np.array([0.2, 0.2]), [])
    assert place.tolist() == [0.2, 0.2]
    assert left == pytest.approx([-5.0])


SKEW = np.array([[30.0, 12.0], [-4.0, 25.0], [9.0, 7.0]])


@pytest.mark.parametrize("coordinate", [0, 1])
def test_a_profile_of_a_linear_model_is_its_parabola(coordinate):
    """The others at their best, the misfit rises by ((x - best)/error)^2 where the covariance is that of white noise.

    With a covariance of four times as much by half of that: ends lie at reach times the error, to the 0.5 % of a search.
    """
    best, inverse = np.array([0.45, 0.55]), np.linalg.inv(SKEW.T @ SKEW)
    for factor, reach in ((1.0, 1.96), (4.0, 2.6)):
        reaches = np.array([reach, reach + 0.4])
        found = Estimate(best, np.zeros(3), SKEW, factor * inverse, np.zeros((2, 0)), reaches)
        search = Search(lambda place: SKEW @ (place - best), 2)
        search.begin(best)
        assert is_quadratic(search, found, coordinate)
        error = np.sqrt(factor * inverse[coordinate, coordinate])
        ends = profile(search, found, coordinate)
        middle, reach = best[coordinate], reaches[coordinate]
        assert [ends.low, ends.high] == pytest.approx([middle - reach * error, middle + reach * error], rel=6e-3)
        assert ends.deviations == pytest.approx((ends.places - middle) / error, abs=1e-3)
        assert 0.0 in ends.deviations
        assert np.all(np.diff(ends.places) > 0.0)


def test_a_profile_ends_at_a_bound_that_the_misfit_does_not_reach():
    """Flat to the left: the lower end is 0; to the right it has risen by 1.96 errors where (x - 0.5)/0.05 is 1.96 + 0.4^2."""

    def residuals(place):
        return np.array([max(place[0] - 0.5, 0.0) / 0.05, 0.0])

    left = np.array([0.0, 0.2])  # elsewhere it is smaller by 0.04: a rise of none
    found = Estimate(np.array([0.5]), left, np.array([[20.0], [0.0]]), np.array([[0.0025]]), np.zeros((1, 0)), [1.96])
    search = Search(residuals, 1)
    search.begin(np.array([0.5]))
    ends = profile(search, found, 0)
    assert ends.low == 0.0
    assert ends.deviations[0] == 0.0
    assert ends.high == pytest.approx(0.5 + 1.96 * 0.05, rel=6e-3)
    assert not is_quadratic(search, found, 0)


@pytest.mark.parametrize(("cubic", "parabola"), [(0.299, True), (0.301, False), (-0.299, True), (-0.301, False)])
def test_a_misfit_within_three_tenths_of_its_parabola_at_two_errors_is_one(cubic, parabola):
    """r^2 = z^2 (1 + c z/2) at z = 2 errors is 1 + c times that of the parabola, 1 - c at -2."""

    def residuals(place):
        z = (place[0] - 0.5) / 0.1
        return np.array([z * np.sqrt(1.0 + cubic * z / 2.0), 0.7])

    left, slopes = np.array([0.0, 0.7]), np.array([[10.0], [0.0]])
    found = Estimate(np.array([0.5]), left, slopes, np.array([[0.01]]), np.zeros((1, 0)), [1.96])
    search = Search(residuals, 1)
    search.begin(np.array([0.5]))
    assert is_quadratic(search, found, 0) == parabola
    for place, answer in (
        (0.795, True),
        (0.805, False),
        (0.195, False),
        (0.205, True),
    ):  # two errors beyond a bound are none
        moved = Search(lambda one, p=place: np.array([(one[0] - p) / 0.1, 0.7]), 1)
        other = Estimate(np.array([place]), left, found.jacobian, found.covariance, np.zeros((1, 0)), [1.96])
        assert is_quadratic(moved, other, 0) == answer
    known = Estimate(np.array([0.5]), np.zeros(1), found.jacobian, np.zeros((1, 1)), np.zeros((1, 0)), [1.96])
    assert is_quadratic(search, known, 0)


class Told(Search):
    """A search whose descents end as they are told; it keeps where they began, and to what accuracy."""

    def __init__(self, residuals, ends):
        super().__init__(residuals, 1)
        self.ends, self.begun = ends, []

    def descend(self, start, free=None, accuracy=ACCURACY):
        self.begun.append((float(start[0]), accuracy))
        end = self.ends[min(len(self.begun), len(self.ends)) - 1]
        return np.array([end[0]]), np.array([end[1]])


def told(monkeypatch, ends, rows=(0.9, 0.05, 0.149, 0.151, 0.39, 0.41, 1.2), explained=lambda left: False):
    """Search from 0.5 and from rows that fit the better the nearer they are to 0; those above 1 cannot be run."""
    asked = []

    def screened(size, count):
        asked.append((size, count))
        return [np.array([row]) for row in rows]

    def residuals(place):
        if place[0] > 1.0:
            raise ValueError("cannot be run")
        return place

    monkeypatch.setattr("strikewave.studies.fit.estimation.latin_hypercube", screened)
    search = Told(residuals, ends)
    found = search.wide(np.array([0.5]), explained)
    assert asked == [(1, 8)]
    assert search.runs == len(rows)
    return [start for start, _ in search.begun], [accuracy for _, accuracy in search.begun], found


def test_searches_begin_at_the_best_of_the_places_tried_that_lie_a_tenth_apart(monkeypatch):
    """0.149 lies 0.099 from 0.05, and 0.41 0.09 from the case at 0.5, where the first begins: they are left out."""
    apart = [(0.1 * k, 9.0 + k) for k in range(9)]
    starts, accuracies, found = told(monkeypatch, apart)
    assert starts == [0.5, 0.05, 0.151, 0.39, 0.9]
    assert accuracies == [1e-7, 1e-4, 1e-4, 1e-4, 1e-4]
    assert [float(left[0]) for _, left in found] == [9.0, 10.0, 11.0, 12.0, 13.0]
    rows = 0.001 * np.arange(0, 1000, 107)
    assert len(told(monkeypatch, apart, rows)[0]) == 8
    for size, count in ((3, 24), (5, 32)):  # eight a value, 32 at most
        search = Search(lambda place: place, size)
        monkeypatch.setattr("strikewave.studies.fit.estimation.latin_hypercube", lambda *asked: pytest.fail(f"{asked}"))
        with pytest.raises(pytest.fail.Exception, match=rf"\({size}, {count}\)"):
            search.wide(np.full(size, 0.5))


def test_three_searches_are_enough_where_they_end_together_or_one_is_explained(monkeypatch):
    """Within 0.01 of the first they are together; what noise explains need not be the first."""
    for second, third, count in ((0.309, 0.309, 3), (0.309, 0.311, 5), (0.311, 0.3, 5)):
        ends = [(0.3, 2.0), (second, 2.1), (third, 2.2), (0.7, 2.3), (0.3, 2.4)]
        assert len(told(monkeypatch, ends)[0]) == count
    ends = [(0.1, 2.0), (0.3, 1.0), (0.6, 3.0)]
    assert len(told(monkeypatch, ends, explained=lambda left: left[0] < 1.5)[0]) == 4  # the best is refined
    assert len(told(monkeypatch, [*ends, (0.8, 4.0)], explained=lambda left: left[0] > 3.5)[0]) == 5


def test_the_best_end_of_another_start_is_refined(monkeypatch):
    starts, accuracies, found = told(monkeypatch, [(0.1, 2.0), (0.3, 1.0), (0.6, 3.0), (0.31, 0.9)], explained=any)
    assert starts == [0.5, 0.05, 0.151, 0.3]
    assert accuracies[-1] == 1e-7
    assert [float(left[0]) for _, left in found] == [0.9, 2.0, 3.0]


def test_a_profile_takes_doubled_steps_until_the_misfit_has_risen_and_a_straight_line_between():
    """A model three times as flat as its covariance says: 1, 2 and 4 times 1.96 errors, then 3 times, where it is met."""
    left, slopes = np.array([0.0, 3.0]), np.array([[50.0], [0.0]])
    found = Estimate(np.array([0.45]), left, slopes, np.array([[4e-4]]), np.zeros((1, 0)), [1.96])
    search = Search(lambda place: np.append((place - 0.45) * 50.0 / 3.0, 3.0), 1)
    search.begin(found.place)
    ends = profile(search, found, 0)
    assert (ends.places - 0.45) / 0.0392 == pytest.approx([-4.0, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0])
    assert ends.deviations == pytest.approx(1.96 / 3.0 * np.arange(-4.0, 5.0))
    assert [ends.low, ends.high] == pytest.approx([0.45 - 0.1176, 0.45 + 0.1176])
    flat = Search(lambda place: np.append((place - 0.45) * 50.0 / 12.5, 3.0), 1)
    flat.begin(found.place)
    ends = profile(flat, found, 0)  # 8 times is 0.314 away, and then there is the bound
    assert ends.places[:5] == pytest.approx([0.0, *(0.45 - 0.0392 * np.array([8.0, 4.0, 2.0, 1.0]))])
    assert ends.low == 0.0
    assert ends.high == pytest.approx(0.45 + 0.0392 * 12.5, rel=6e-3)


def test_slopes_of_a_descent_are_taken_a_ten_thousandth_beside_it():
    asked = []

    def residuals(place):
        asked.append(float(place[0]))
        return 3.0 * (place - 0.4)

    search = Search(residuals, 1)
    search.begin(np.array([0.7]))
    search.descend(np.array([0.7]))
    assert asked[:3] == pytest.approx([0.7, 0.7, 0.7001], abs=1e-9)
    beyond = []
    for start in (-0.2, 1.2):  # a start at a bound is taken a millionth within
        asked.clear()
        search.descend(np.array([start]))
        beyond.append(asked[0])
    assert beyond == pytest.approx([1e-6, 1.0 - 1e-6], abs=1e-12)


def test_slopes_at_a_bound_use_what_is_left_of_the_step():
    """At 0.9999 and 0.0001 with steps of 0.001: down by one, and up by one; the other side is cut off at the bound."""
    place = np.array([0.9999, 0.0001])
    search = Search(lambda one: np.array([one[0] ** 2, one[1] ** 2]), 2)
    middle = search.begin(place)
    both = search.slopes(place, middle, 1e-3, both=True)
    # of a square between a and b: a + b
    assert both == pytest.approx(np.diag([0.9989 + 1.0, 0.0011]), abs=1e-12)


def test_a_search_ends_at_a_bound_beyond_which_it_would_go():
    for best, bound in ((-0.3, 0.0), (1.3, 1.0)):
        search = Search(lambda place, best=best: 5.0 * (place - best), 1)
        search.begin(np.array([0.5]))
        assert search.descend(np.array([0.5]))[0] == pytest.approx([bound], abs=1e-4)


def test_a_search_takes_40_steps_at_most():
    """(x - 0.5)^9 is left by a ninth in each step of Gauss and Newton: residuals and slopes are one run each."""
    search = Search(lambda place: 1e14 * (place - 0.5) ** 9, 1)
    search.begin(np.array([0.9]))
    place, _ = search.descend(np.array([0.9]))
    assert 70 <= search.runs <= 80
    assert abs(place[0] - 0.5) < 0.1


def test_other_residuals_are_searched_over_the_same_stairs():
    asked = []

    def residuals(place):
        asked.append(float(place[0]))
        return place

    other = Search(lambda place: place, 1, stairs=np.array([0.02])).of_others(residuals)
    other.slopes(np.array([0.3]), np.array([0.3]), 1e-3)
    assert asked == pytest.approx([0.36])


def end_of_profile(below, above, cliff):
    """Return end and points to the right of 0.5, over 1.96 errors, of a misfit with a cliff so many errors away."""
    found = Estimate(np.array([0.5]), np.zeros(1), np.array([[20.0]]), np.array([[0.0025]]), np.zeros((1, 0)), [1.96])
    search = Search(lambda place: np.array([below if abs(place[0] - 0.5) < cliff * 0.05 else above]), 1)
    search.begin(found.place)
    ends = profile(search, found, 0)
    return (ends.high - 0.5) / 0.098, (ends.places[ends.places > 0.5] - 0.5) / 0.098


def test_an_end_is_sought_between_a_tenth_and_nine_tenths_of_where_it_lies_and_twelve_times():
    """From 0 to 100 the straight line says a fiftieth; from 1.9 to 1.961 it says 0.98, and from 0.9 on the same."""
    _, places = end_of_profile(0.0, 100.0, 1.9)
    assert places.size == 13
    assert places[:3] == pytest.approx([0.1, 0.19, 0.271])
    for above, steps in ((1.9697, 3), (1.96985, 4)):  # from 0.5 % of 1.96 on it is met
        assert (end_of_profile(1.9, above, 0.95 * 1.96)[1].size > 3) == (steps > 3)
    end, places = end_of_profile(1.9, 1.961, 0.95 * 1.96)
    assert places == pytest.approx([0.9, 0.99, 1.0])
    assert end == pytest.approx(0.99)


@pytest.mark.parametrize(("width", "places"), [(0.445, [0.005, 0.45, 0.895]), (0.555, [0.0, 0.45, 1.0])])
def test_a_profile_goes_to_its_bounds_and_no_farther(width, places):
    """0.445 to either side of 0.45 lies within 0 to 1, 0.555 does not: there it is looked at the bounds."""
    error = width / 1.96
    found = Estimate(np.array([0.45]), np.zeros(1), np.array([[1.0]]), np.array([[error**2]]), np.zeros((1, 0)), [1.96])
    search = Search(lambda place: (place - 0.45) / error * 1.5, 1)
    search.begin(found.place)
    ends = profile(search, found, 0)
    for place in places:
        assert np.min(np.abs(ends.places - place)) < 1e-12
    flat = Search(lambda place: 0.0 * place, 1)
    flat.begin(found.place)
    ends = profile(flat, found, 0)
    assert [ends.low, ends.high, *ends.places[[0, -1]]] == [0.0, 1.0, 0.0, 1.0]


def test_slopes_are_none_at_a_bound_where_no_place_beside_it_runs_and_a_misfit_beyond_one_is_no_parabola():
    def edge(place):
        if place[0] > 0.0:
            raise ValueError("cannot be run")
        return place + 1.0

    search = Search(edge, 1)
    middle = search.begin(np.zeros(1))
    assert search.slopes(np.zeros(1), middle, 1e-3, both=True).tolist() == [[0.0]]
    best, covariance = np.array([0.5, 0.01]), np.array([[4e-4, 4e-4], [4e-4, 1e-3]])
    slopes = np.linalg.inv(np.linalg.cholesky(covariance))
    found = Estimate(best, np.zeros(2), slopes, covariance, np.zeros((2, 0)), np.full(2, 1.96))
    search = Search(lambda place: slopes @ (place - best), 2)
    assert not is_quadratic(search, found, 0)  # along the first the other goes to -0.03


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_the_colour_of_noise_is_that_whatever_its_unit(scale):
    noise = coloured(np.random.default_rng(3), 0.8, 300)
    found = autocorrelation(noise)
    assert found.size > 5
    assert autocorrelation(scale * noise + 7.0 * scale) == pytest.approx(found, abs=1e-9)
