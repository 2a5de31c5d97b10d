"""Kernels of blows: they are found, sorted into trains, freed of noise, read off, and fitted by smooth pulses.

The modules `contacts` and `pulse_shape` of `strikewave.records` explain them. Parameters of a smooth pulse, in this
order: peak, begin, length, share of rise, power.
"""

import math

import numpy as np

from strikewave.base.compiled import inner_kernel, kernel, leaf_kernel


@kernel
def strongest_boxes(values, level, slope, width, sign, least, boxes):
    """Write the local maxima of the mean over a sliding box, ``sign`` times, above ``least``; return how many.

    ``boxes`` has a row for each: first sample of the box, mean. Maxima closer than a box are one. The line
    ``level + slope k`` is taken off.
    """
    n = values.size
    total = 0.0
    for k in range(width):
        total += values[k] - level - slope * k
    best, place, count = -np.inf, -1, 0
    for k in range(n - width + 1):  # one sample enters the box and one leaves it: the time does not grow with the width
        mean = sign * total / width
        if mean > best:
            best, place = mean, k
        elif place >= 0 and k - place >= width:  # the maximum is a width behind: what comes now is another one
            if best > least and count < boxes.shape[0]:
                boxes[count, 0], boxes[count, 1] = place, best
                count += 1
            best, place = mean, k
        if k + width < n:
            total += values[k + width] - values[k] - slope * width
    if place >= 0 and best > least and count < boxes.shape[0]:
        boxes[count, 0], boxes[count, 1] = place, best
        count += 1
    return count


@kernel
def best_chains(times, weights, period, penalty, most_periods, jitter):
    """Return the weight of the best chain that ends at each contact, and the contact before it; -1 where it begins."""
    score, before = weights.copy(), np.full(times.size, -1)
    first = 0
    for k in range(1, times.size):
        while times[first] < times[k] - (most_periods + jitter) * period:
            first += 1  # no later contact looks back so far: each is passed once
        best = 0.0
        for earlier in range(first, k):
            gap = (times[k] - times[earlier]) / period
            count = np.rint(gap)
            gain = score[earlier] - (count - 1.0) * penalty
            if count >= 1.0 and abs(gap - count) < jitter and gain > best:
                best, before[k] = gain, earlier
        score[k] += best
    return score, before


@kernel
def row_figures(rows, first, last, width, low, high):
    """Return place, peak, rise and width of the largest value of each row between two samples.

    The width is taken at the share ``width`` of the peak, the rise from its share ``low`` to ``high``.
    """
    figures = np.empty((rows.shape[0], 4))
    for r in range(rows.shape[0]):
        row = rows[r]
        top = first
        for k in range(first + 1, last):
            if row[k] > row[top]:
                top = k
        shift, peak = 0.0, row[top]
        if 0 < top < row.size - 1:
            left, right = row[top - 1], row[top + 1]
            curvature = left - 2.0 * peak + right
            if curvature < 0.0:  # on a plateau the parabola has no vertex
                shift = 0.5 * (left - right) / curvature
                peak -= 0.25 * (left - right) * shift
        figures[r, 0], figures[r, 1] = top + shift, peak
        figures[r, 2] = crossed(row, top, high * peak, -1) - crossed(row, top, low * peak, -1)
        figures[r, 3] = crossed(row, top, width * peak, 1) - crossed(row, top, width * peak, -1)
    return figures


@leaf_kernel
def crossed(row, top, level, side):
    """Return where a row first falls to a level, before its top (-1) or after it; NaN where it does not."""
    k = top
    while 0 <= k < row.size and row[k] > level:
        k += side
    if not (0 <= k < row.size and level > 0.0):
        return math.nan
    above = row[min(max(k - side, 0), row.size - 1)]
    return k - side * (level - row[k]) / (above - row[k]) if above > row[k] else float(k)


@kernel
def smoothed_rows(rows, weights):
    """Return rows whose samples are sums of those around them, with some weights; the first and last sample go on."""
    half, count = weights.size // 2, rows.shape[1]
    smoothed = np.zeros_like(rows)
    padded = np.empty(count + 2 * half)
    for r in range(rows.shape[0]):
        padded[:half] = rows[r, 0]
        padded[half : half + count] = rows[r]
        padded[half + count :] = rows[r, count - 1]
        for j in range(weights.size):
            for k in range(count):
                smoothed[r, k] += weights[j] * padded[j + k]
    return smoothed


PARAMETERS = 5
FOOT = 1e-8  # sine of a sample at a foot: there the slope of a power below one grows without bound
# Damping of the first step, over the largest square of the slopes; where it has grown to the second no step helps
FIRST_DAMPING, MOST_DAMPING = 0.1, 1e12
NO_BETTER = 1e-8  # share of the squares by which a step must lower them, or the fit ends: rounding is 1e-16 of them


@kernel
def unit_pulses(since, shares, powers):
    """Return pulses of peak one, a row each with its share of rise and its power, at times since begin over length."""
    pulses = np.zeros_like(since)
    for r in range(since.shape[0]):
        for k in range(since.shape[1]):
            if 0.0 < since[r, k] < 1.0:
                part, _ = part_of_side(since[r, k], shares[r])
                pulses[r, k] = math.sin(0.5 * math.pi * part) ** powers[r]
    return pulses


@leaf_kernel
def part_of_side(since, share):
    """Return how much of its side is over, from its foot on, and how long that lasts; less than 0 where it falls."""
    if since < share:
        return since / share, share
    return (1.0 - since) / (1.0 - share), share - 1.0


@kernel
def fit_pulse(time, values, start, low, high, spreads, rounds, converged):
    """Return the pulse within bounds whose squares of what it misses are least, and these.

    A step is that of Levenberg and Marquardt in the parameters that no bound holds, over ``spreads``; what goes beyond
    a bound is put on it. The fit ends after so many evaluations, or where a step is shorter than a share of the pulse.

    Sources: D. W. Marquardt, An algorithm for least-squares estimation of nonlinear parameters, Journal of the Society
    for Industrial and Applied Mathematics 11 (1963) 431-441; H. B. Nielsen, Damping parameter in Marquardt's method,
    IMM-REP-1999-05, Technical University of Denmark (1999), for the damping.
    """
    pulse, vectors, matrices = start.copy(), np.empty((5, PARAMETERS)), np.empty((3, PARAMETERS, PARAMETERS))
    trial, step, slope, gradient, next_gradient = vectors[0], vectors[1], vectors[2], vectors[3], vectors[4]
    normal, next_normal, factor = matrices[0], matrices[1], matrices[2]
    squares = normal_equations(time, values, pulse, spreads, slope, normal, gradient)
    damping, growth = FIRST_DAMPING * np.max(np.diag(normal)), 2.0
    for _ in range(rounds - 1):
        # a parameter on its bound moves no further out, and does not bend the step of the others
        held = ((pulse <= low) & (gradient > 0.0)) | ((pulse >= high) & (gradient < 0.0))
        solve_damped(normal, gradient, damping, held, factor, step)
        expected = 0.0
        for i in range(PARAMETERS):
            trial[i] = min(max(pulse[i] + spreads[i] * step[i], low[i]), high[i])
            step[i] = (trial[i] - pulse[i]) / spreads[i]  # as taken: the gain is that of the clamped step
            expected += step[i] * (damping * step[i] - gradient[i])
        next_squares = normal_equations(time, values, trial, spreads, slope, next_normal, next_gradient)
        gained = squares - next_squares
        short = np.sqrt(np.sum(step**2)) < converged * np.sqrt(np.sum((pulse / spreads) ** 2))
        if gained > 0.0:
            done = short or gained < NO_BETTER * squares
            gain = gained / expected if expected > gained else 1.0  # a step that gains more than promised is trusted
            damping *= max(1.0 / 3.0, 1.0 - (2.0 * gain - 1.0) ** 3)
            growth = 2.0
            squares = next_squares
            pulse[:] = trial
            normal[:] = next_normal
            gradient[:] = next_gradient
        else:
            done = short or damping > MOST_DAMPING
            damping *= growth
            growth *= 2.0
        if done:
            break
    return pulse, squares


@inner_kernel
def normal_equations(time, values, pulse, spreads, slope, normal, gradient):
    """Return the squares of what a pulse misses; write the normal matrix, its lower half, and the gradient."""
    peak, begin, length, share, power = pulse[0], pulse[1], pulse[2], pulse[3], pulse[4]
    squares = 0.0
    normal[:] = 0.0
    gradient[:] = 0.0
    for k in range(time.size):
        since = (time[k] - begin) / length
        sine = 0.0
        if 0.0 < since < 1.0:
            part, side = part_of_side(since, share)
            sine = math.sin(0.5 * math.pi * part)
        if sine < FOOT:  # outside, or at a foot: the pulse is zero and has no slope that could be used
            squares += values[k] ** 2
            continue
        unit = sine**power
        rest = peak * unit - values[k]
        squares += rest**2
        along = 0.5 * math.pi / side * peak * power * unit / sine * math.cos(0.5 * math.pi * part)
        slope[0] = unit
        slope[1] = -along / length
        slope[2] = -along * since / length
        slope[3] = -along * part
        slope[4] = peak * unit * math.log(sine)
        for i in range(PARAMETERS):
            slope[i] *= spreads[i]
            gradient[i] += slope[i] * rest
            for j in range(i + 1):
                normal[i, j] += slope[i] * slope[j]
    return squares


@inner_kernel
def solve_damped(normal, gradient, damping, held, factor, step):
    """Write the step -(N + d I)^-1 g by Cholesky's factor; none in parameters that are held."""
    for i in range(PARAMETERS):
        for j in range(i + 1):
            total = damping if i == j else 0.0
            if not (held[i] or held[j]):  # a held row is the damping alone: the factor keeps its shape
                total += normal[i, j]
            for k in range(j):
                total -= factor[i, k] * factor[j, k]
            factor[i, j] = math.sqrt(total) if i == j else total / factor[j, j]
    for i in range(PARAMETERS):
        step[i] = 0.0 if held[i] else -gradient[i]
        for k in range(i):
            step[i] -= factor[i, k] * step[k]
        step[i] /= factor[i, i]
    for i in range(PARAMETERS - 1, -1, -1):
        for k in range(i + 1, PARAMETERS):
            step[i] -= factor[k, i] * step[k]
        step[i] /= factor[i, i]
