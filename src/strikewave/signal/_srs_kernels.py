"""The time loop of shock response spectra: all frequencies of one sample side by side, in one pass over the record.

An oscillator follows y_{k+1} = y_k + d_{k+1} with d_{k+1} = decay d_k - stiffness y_k + x_{k+1} + first x_k +
second x_{k-1}. Adding increments keeps the digits that the usual form 2 E cos K y_k - E^2 y_{k-1} loses when many
samples fall in a period. Responses are in units of the weight of the newest sample, which saves a product.

Rows of ``filters``: decay, stiffness, first, second. Rows of ``state``: y, d. Rows of the segments' ``record``:
largest y, smallest y, and y and d before the segment's first sample.
"""

import numpy as np

from strikewave.base.compiled import fused_kernel, leaf_kernel

SEGMENT = 512
"""Samples whose extremes are kept together; a segment that may hold the peak is gone through again. Chosen: longer ones
cost more to go through again, shorter ones more memory for their extremes."""

CLOSE = 1e-6
"""Share of the peak by which a segment must be able to exceed it to be gone through: at most this much of a peak is
missed, far less than a record is exact, and the many segments of a steady vibration, all as high, are left out."""
_EARLIER = 1e-9
"""Share by which the best sample of a segment is lowered when that segment is gone through again, so that the step that
holds it counts as better in spite of rounding."""

NOTHING = 1e-280
"""Responses below are set to zero: below 2e-308 numbers lose digits, and processors need a hundred times as long for
them. The distance leaves room for products with small weights."""


@fused_kernel
def march(x, before, filters, state, record):
    """Take all oscillators through the samples; write the extremes of each segment.

    Four samples a pass over the frequencies: the states then stay in registers, and the inner loop is one of
    vectors of frequencies (checked in the assembly: seven instructions a sample and vector).
    """
    size, count = x.size, filters.shape[1]
    decay, stiffness, first, second = filters[0], filters[1], filters[2], filters[3]
    high, low = np.empty(count), np.empty(count)
    response, change = state[0], state[1]
    a, b = before[0], before[1]
    for segment in range(record.shape[1]):
        for j in range(count):
            if abs(response[j]) + abs(change[j]) < NOTHING:
                response[j], change[j] = 0.0, 0.0
            high[j], low[j] = response[j], response[j]
            record[2, segment, j], record[3, segment, j] = response[j], change[j]
        k, end = segment * SEGMENT, min(size, (segment + 1) * SEGMENT)
        while k + 4 <= end:
            p, q, r, s = x[k], x[k + 1], x[k + 2], x[k + 3]
            for j in range(count):
                e, g, f, h = decay[j], stiffness[j], first[j], second[j]
                y, d, top, bottom = response[j], change[j], high[j], low[j]
                d = e * d + (p + f * b + h * a - g * y)
                y = y + d
                top = y if y > top else top
                bottom = y if y < bottom else bottom
                d = e * d + (q + f * p + h * b - g * y)
                y = y + d
                top = y if y > top else top
                bottom = y if y < bottom else bottom
                d = e * d + (r + f * q + h * p - g * y)
                y = y + d
                top = y if y > top else top
                bottom = y if y < bottom else bottom
                d = e * d + (s + f * r + h * q - g * y)
                y = y + d
                top = y if y > top else top
                bottom = y if y < bottom else bottom
                response[j], change[j], high[j], low[j] = y, d, top, bottom
            a, b = r, s
            k += 4
        while k < end:
            p = x[k]
            for j in range(count):
                d = decay[j] * change[j] + (p + first[j] * b + second[j] * a - stiffness[j] * response[j])
                y = response[j] + d
                response[j], change[j] = y, d
                high[j], low[j] = max(y, high[j]), min(y, low[j])
            a, b = b, p
            k += 1
        record[0, segment], record[1, segment] = high, low


@fused_kernel
def follow(x, before, filters, state, history):
    """Take all oscillators through the samples; write each response, a row a sample."""
    decay, stiffness, first, second = filters[0], filters[1], filters[2], filters[3]
    response, change = state[0], state[1]
    a, b = before[0], before[1]
    for k in range(x.size):
        p = x[k]
        for j in range(history.shape[1]):
            d = decay[j] * change[j] + (p + first[j] * b + second[j] * a - stiffness[j] * response[j])
            y = response[j] + d
            response[j], change[j], history[k, j] = y, d, y
        a, b = b, p


@fused_kernel
def loads(x, before, record):
    """Write the largest sample and the largest step between samples of each segment."""
    last = before[1]
    for segment in range(record.shape[1]):
        size, slope = abs(last), 0.0
        for k in range(segment * SEGMENT, min(x.size, (segment + 1) * SEGMENT)):
            size, slope = max(size, abs(x[k])), max(slope, abs(x[k] - last))
            last = x[k]
        record[0, segment], record[1, segment] = size, slope


@leaf_kernel
def top_within(sign, start, change, flat, rising, bends, places):
    """Return place and height of the largest value in one step: a parabola through the best of several places.

    The response between samples is y_k + u d_{k+1} + flat P(u) + rising R(u), see ``oscillators.bend``.
    """
    best, where = -np.inf, 0
    for i in range(places.size):
        value = sign * (start + places[i] * change + flat * bends[0, i] + rising * bends[1, i])
        if value > best:
            best, where = value, i
    i = min(max(where, 1), places.size - 2)
    u, v, w = places[i - 1], places[i], places[i + 1]
    f = sign * (start + u * change + flat * bends[0, i - 1] + rising * bends[1, i - 1])
    g = sign * (start + v * change + flat * bends[0, i] + rising * bends[1, i])
    h = sign * (start + w * change + flat * bends[0, i + 1] + rising * bends[1, i + 1])
    rise, fall = (g - f) / (v - u), (h - g) / (w - v)
    curvature = (fall - rise) / (w - u)
    if curvature < 0.0:
        place = 0.5 * (u + v) - 0.5 * rise / curvature
        if u < place < w:
            return place, f + (place - u) * (rise + curvature * (place - v))
    return places[where], best


@fused_kernel
def sharpen(sign, x, before, filters, shapes, bends, places, record, load, peaks):
    """Find for each frequency the step that holds the largest response of one sign.

    A segment or a step is looked into only if its samples and the bound of what lies between them exceed the best
    so far. Rows of ``shapes``: see ``oscillators.Bank``. Rows of ``peaks``: place in the step, response before the
    step, its change, and the two loads that `top_within` calls flat and rising.
    """
    segments, count = record.shape[1], record.shape[2]
    row = 0 if sign > 0.0 else 1
    for j in range(count):
        e, g, f, h = filters[0, j], filters[1, j], filters[2, j], filters[3, j]
        square, double, on_level, on_slope = shapes[0, j], shapes[1, j], shapes[2, j], shapes[3, j]
        most = 0
        for segment in range(segments):
            if sign * record[row, segment, j] > sign * record[row, most, j]:
                most = segment
        best = sign * record[row, most, j]
        best -= _EARLIER * abs(best)
        for turn in range(segments + 1):
            segment = most if turn == 0 else turn - 1
            if turn > 0:
                size = max(abs(record[0, segment, j]), abs(record[1, segment, j]))
                bound = shapes[6, j] * size + shapes[7, j] * load[0, segment] + shapes[8, j] * load[1, segment]
                if segment == most or sign * record[row, segment, j] + bound <= best + CLOSE * abs(best):
                    continue
            y, d = record[2, segment, j], record[3, segment, j]
            begin = segment * SEGMENT
            b = x[begin - 1] if begin > 0 else before[1]
            a = x[begin - 2] if begin > 0 else before[0]
            for k in range(begin, min(x.size, begin + SEGMENT)):
                p = x[k]
                d = e * d + (p + f * b + h * a - g * y)
                flat = square * y + double * d - on_level * b - on_slope * (p - b)
                rising = square * d - on_level * (p - b)
                if max(sign * y, sign * (y + d)) + shapes[4, j] * abs(flat) + shapes[5, j] * abs(rising) > best:
                    place, height = top_within(sign, y, d, flat, rising, bends[:, j], places)
                    if height > best:
                        best = height
                        peaks[0, j], peaks[1, j], peaks[2, j], peaks[3, j], peaks[4, j] = place, y, d, flat, rising
                a, b, y = b, p, y + d
