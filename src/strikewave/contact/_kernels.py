"""Compiled closed form of one impact of two free bodies under F = K d^n (1 + chi d'/v0).

The phase plane of the law is integrable. With y = chi d'/v0, u = ln(1 + y) and
Lambda = chi - ln(1 + chi),

    K d^(n+1) chi^2 / ((n+1) m v0^2) = G(u) = Lambda + 1 + u - exp(u),

so that the contact begins at u_c = ln(1 + chi), ends at u_e = ln(1 - e chi), and L = u_c - u_e =
chi (1 + e). Everything below follows from G, whatever n, K, m and v0 are.
"""

import math

import numpy as np

from strikewave.base.compiled import kernel, leaf_kernel

_SERIES = 0.35
"""|x| below which exp(x) - 1 - x is its series: 2e-16 off there, while the difference of two numbers loses 7e-16 and
more (measured against 50 digits)."""
_LOG_SERIES = 0.08
"""|y| below which y - ln(1 + y) is its series: 2e-16 off there and 3e-15 at 0.12; the difference loses 2e-15
(measured)."""
_LOSS_SERIES, _SLOPE_SERIES, _NO_SPAN = 0.5, 1e-3, 1e-12
"""L below which 1 - e is its series (3e-16 off up to 0.8, while the closed form loses 2e-14 at 0.5); below which its
slope is 1/3 (3e-4 off, which Newton steps bear, while the closed form is nothing but rounding as L falls); and below
which 1 - e = L/3 to the last bit."""
_RESTITUTION_BY_LOSS = 1.0
"""L below which e comes from 1 - e, where that keeps its digits."""
_PHI = np.array([1.0 / math.factorial(k) for k in range(15, 1, -1)])
_LOSS = np.array([(-1.0) ** (k + 1) * (k - 2) / math.factorial(k) for k in range(18, 2, -1)])
_LOG = np.array([(-1.0) ** k / k for k in range(16, 1, -1)])
"""Coefficients of the three series, highest power first: as many as reach rounding within the limits above."""

_ELASTIC = 1e-12
"""Factor that stands for none where histories are wanted, which divide by it: it changes them by as much."""
_REACH = 3.8  # 3.4 leaves 1e-8, and 4.2 needs more nodes for a small restitution (measured, n from 1 to 2)
"""End of the double exponential rule on its own axis; the rest is added in closed form, to 5e-12."""
_NODES, _NODES_WIDE, _WIDE_SPAN = 40, 72, 12.0
"""Nodes of the rule, and more of them for L above 12, that is e below 0.09. With 40 a duration is good to 1e-11 at L =
11 but only to 1e-9 at 21; with 72 it is good to 6e-12 at L = 100, e = 0.01 (measured against 400 nodes)."""
_STEPS, _ROUNDING, _LAST_BIT = 100, 4e-16, 2e-16
"""Newton steps at most, and relative changes that end them: two bits and one. Restitutions of 1e-6 take 45 steps, usual
ones fewer than ten (measured); where the last bit flips forever the cap ends it, and the result is as good."""
_PLACE_STEPS, _PLACE_ROUNDING = 60, 1e-13
"""The same for the place at a time: the integral itself is good to 5e-12, and a bit of it is not worth a step. The
longest of 2400 searches took 47."""
_NO_HYSTERESIS = 1e-9
"""Factor below which an impact is solved as elastic: deepest indentation, force and duration change by less than that,
and the closed form would divide by the square of the factor."""


def _double_exponential(nodes):
    """Return distance to the near end, weights, and the distance beyond which the tail is analytic."""
    t = np.linspace(-_REACH, _REACH, nodes)
    step = t[1] - t[0]
    near = 1.0 / (1.0 + np.exp(math.pi * np.sinh(np.abs(t))))
    weight = step * 0.25 * math.pi * np.cosh(t) / np.cosh(0.5 * math.pi * np.sinh(t)) ** 2
    return near, weight, 1.0 / (1.0 + math.exp(math.pi * math.sinh(_REACH + 0.5 * step)))


_NEAR, _WEIGHT, _TAIL = _double_exponential(_NODES)
_NEAR_WIDE, _WEIGHT_WIDE, _TAIL_WIDE = _double_exponential(_NODES_WIDE)


@kernel
def polynomial(coefficients, x):
    """Return a polynomial, highest coefficient first (Horner)."""
    total = 0.0
    for c in coefficients:
        total = total * x + c
    return total


@kernel
def phi(x):
    """Return exp(x) - 1 - x without cancellation near zero."""
    if abs(x) > _SERIES:
        return math.expm1(x) - x
    return polynomial(_PHI, x) * x * x


@kernel
def log_rest(y):
    """Return y - ln(1 + y) without cancellation near zero (y > -1)."""
    if abs(y) > _LOG_SERIES:
        return y - math.log1p(y)
    return polynomial(_LOG, y) * y * y


@kernel
def loss_of_span(span):
    """Return 1 - e and its derivative for L = chi (1 + e).

    1 - e = [L - 2 + (L + 2) exp(-L)] / D and d(1 - e)/dL = [(1 - exp(-L)) e - L exp(-L)] / D with
    D = L - 1 + exp(-L).
    """
    if span < _NO_SPAN:
        return span / 3.0, 1.0 / 3.0
    below = phi(-span)
    decay = math.exp(-span)
    loss = polynomial(_LOSS, span) * span**3 if span < _LOSS_SERIES else span - 2.0 + (span + 2.0) * decay
    loss /= below
    slope = 1.0 / 3.0 if span < _SLOPE_SERIES else (-math.expm1(-span) * (1.0 - loss) - span * decay) / below
    return loss, slope


@kernel
def restitution_of_span(span):
    """Return e = [1 - exp(-L)(1 + L)] / (L - 1 + exp(-L)) for L = chi (1 + e)."""
    if span < _RESTITUTION_BY_LOSS:
        return 1.0 - loss_of_span(span)[0]
    decay = math.exp(-span)
    return (1.0 - decay * (1.0 + span)) / (span - 1.0 + decay)


@kernel
def span_of_restitution(e):
    """Return L = chi (1 + e) that gives the restitution e, 0 < e <= 1, by guarded Newton steps."""
    if e >= 1.0:
        return 0.0
    lost = 1.0 - e
    low, high = 2.0 * lost, 3.0 + 1.0 / e  # L is 3 (1 - e) near e = 1, and 1 + 1/e for small e
    # begins at the estimate of Carvalho & Martins 2019, within 23 % for e above 0.1, and at 1 + 1/e for small e
    span = min(1.5 * lost * (11.0 - e) / (1.0 + 9.0 * e) * (1.0 + e), 1.0 + 1.0 / e)
    for _ in range(_STEPS):
        if span > _RESTITUTION_BY_LOSS:  # by e or by 1 - e, whichever is small and so has more digits
            residual = e - restitution_of_span(span)
            slope = loss_of_span(span)[1]
        else:
            loss, slope = loss_of_span(span)
            residual = loss - lost
        if residual < 0.0:
            low = span
        else:
            high = span
        new = span - residual / slope
        if not low < new < high:
            new = math.sqrt(low * high)  # the middle in logarithms: L spans decades
        if abs(new - span) <= _ROUNDING * span:
            return new
        span = new
    return span


@kernel
def span_of_factor(chi):
    """Return L with L = chi (1 + e(L)) by guarded Newton steps."""
    if chi <= 0.0:
        return 0.0
    low, high = chi, 2.0 * chi
    # L = chi (1 + e) lies between chi and 2 chi: 1.6 chi is near enough to begin
    span = chi * (1.0 + restitution_of_span(1.6 * chi))
    for _ in range(_STEPS):
        loss, slope = loss_of_span(span)
        residual = span - chi * (2.0 - loss)
        if residual < 0.0:
            low = span
        else:
            high = span
        new = span - residual / (1.0 + chi * slope)
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - span) <= _ROUNDING * span:
            return new
        span = new
    return span


@kernel
def peak_rate(exponent, chi):
    """Return y = chi d'/v0 at the largest force: the positive root of a y - ln(1 + y) = Lambda."""
    a = (2.0 * exponent + 1.0) / (exponent + 1.0)
    lam = log_rest(chi)
    y = min(lam / (a - 1.0), chi)  # above the root of a convex function: Newton's steps need no bracket
    for _ in range(_STEPS):
        residual = (a - 1.0) * y + log_rest(y) - lam
        new = y - residual / (a - 1.0 / (1.0 + y))
        if abs(new - y) <= _LAST_BIT * abs(y):
            return new
        y = new
    return y


@leaf_kernel
def from_begin(chi, w):
    """Return G at w = u_c - u after first touch."""
    return chi * -math.expm1(-w) - phi(-w)


@leaf_kernel
def from_end(chi, e, span, w):
    """Return G at w = u - u_e before the release, where 1 + y is 1 - e chi = (1 + chi) exp(-L)."""
    late = (1.0 + chi) * math.exp(-span)
    grown = late * phi(w) if w < 1.0 else (1.0 + chi) * math.exp(w - span) - late * (1.0 + w)
    return w * e * chi - grown


@kernel
def duration_integral(exponent, chi, e, span):
    """Return the integral of G(u)^(-n/(n+1)) over the contact by the double exponential rule.

    The integrand is singular at both ends; the rule's nodes crowd there (Takahasi & Mori 1974) and the
    last stretch is integrated by its leading power. Each half is measured from its own end, so that G
    keeps its digits. Relative error 2e-11, and 1e-10 for e below 0.08 (n from 1 to 2).
    """
    if span < _WIDE_SPAN:
        near, weight, tail = _NEAR, _WEIGHT, _TAIL
    else:
        near, weight, tail = _NEAR_WIDE, _WEIGHT_WIDE, _TAIL_WIDE
    power = -exponent / (exponent + 1.0)
    total = 0.0
    for k in range(near.size):
        w = span * near[k]
        g = from_end(chi, e, span, w) if 2 * k < near.size else from_begin(chi, w)
        total += weight[k] * g**power
    ends = (exponent + 1.0) * (span * tail) ** (1.0 / (exponent + 1.0)) * (chi**power + (e * chi) ** power)
    return span * total + ends


@kernel
def stretch_integral(exponent, chi, e, far, released):
    """Return the integral of G(u)^(-n/(n+1)) over w = 0 .. far from one end of the contact, up to its turning point.

    ``released`` tells which end. The rule is that of `duration_integral`.
    """
    power, span = -exponent / (exponent + 1.0), chi * (1.0 + e)
    total = 0.0
    for k in range(_NEAR_WIDE.size):
        w = far * _NEAR_WIDE[k] if 2 * k < _NEAR_WIDE.size else far * (1.0 - _NEAR_WIDE[k])
        g = from_end(chi, e, span, w) if released else from_begin(chi, w)
        total += _WEIGHT_WIDE[k] * g**power
    steep = e * chi if released else chi
    end = (exponent + 1.0) * (far * _TAIL_WIDE) ** (1.0 / (exponent + 1.0)) * steep**power
    return far * total + end


@leaf_kernel
def time_unit(stiffness, exponent, chi, mass, speed):
    """Return the time that one unit of the integrals stands for, s."""
    depth = ((exponent + 1.0) * mass * speed**2 / (chi * chi * stiffness)) ** (1.0 / (exponent + 1.0))
    return speed * mass / (chi * stiffness) * depth**-exponent


@kernel
def impact(stiffness, exponent, chi, mass, speed):
    """Return restitution, largest indentation, largest force and duration of one impact."""
    n = exponent
    if chi < _NO_HYSTERESIS:
        deepest = ((n + 1.0) * mass * speed**2 / (2.0 * stiffness)) ** (1.0 / (n + 1.0))
        q = 1.0 / (n + 1.0)
        kappa = 2.0 * math.sqrt(math.pi) * q * math.exp(math.lgamma(q) - math.lgamma(q + 0.5))
        return restitution_of_span(span_of_factor(chi)), deepest, stiffness * deepest**n, kappa * deepest / speed
    span = span_of_factor(chi)
    e = restitution_of_span(span)
    unit = mass * speed**2 / (chi * chi * stiffness)
    deepest = ((n + 1.0) * unit * log_rest(chi)) ** (1.0 / (n + 1.0))
    y = peak_rate(n, chi)
    at_peak = (n * unit * y) ** (1.0 / (n + 1.0))
    force = stiffness * at_peak**n * (1.0 + y)
    duration = time_unit(stiffness, n, chi, mass, speed) * duration_integral(n, chi, e, span)
    return e, deepest, force, duration


@kernel
def moments(stiffness, exponent, chi, mass, speed):
    """Return when the force is largest, when the indentation is, and when the contact ends, after first touch."""
    n, chi = exponent, max(chi, _ELASTIC)  # the integrals divide by chi
    span, turn = span_of_factor(chi), math.log1p(chi)
    e = restitution_of_span(span)
    unit = time_unit(stiffness, n, chi, mass, speed)
    peak = unit * stretch_integral(n, chi, e, turn - math.log1p(peak_rate(n, chi)), False)
    turned = unit * stretch_integral(n, chi, e, turn, False)
    return peak, turned, turned + unit * stretch_integral(n, chi, e, span - turn, True)


@kernel
def all_moments(stiffness, exponent, chi, mass, speed, out):
    """Fill ``out`` (2, N) with the times of the largest force and the largest indentation of N impacts."""
    for i in range(stiffness.size):
        out[0, i], out[1, i], _ = moments(stiffness[i], exponent[i], chi[i], mass[i], speed[i])


@kernel
def distance_at(exponent, chi, e, integral, far, released):
    """Return w, from the end of the contact that ``released`` tells, at which the stretch integral has a value.

    Newton steps in w^(1/(n+1)), in which the integral begins straight; bisection where one leaves the bracket.
    """
    n, span = exponent, chi * (1.0 + e)
    power, steep = -n / (n + 1.0), e * chi if released else chi
    low, high = 0.0, far
    w = min((integral * steep**-power / (n + 1.0)) ** (n + 1.0), far)  # the leading power, exact near the end
    for _ in range(_PLACE_STEPS):
        miss = stretch_integral(n, chi, e, w, released) - integral
        if miss > 0.0:
            high = w
        else:
            low = w
        g = from_end(chi, e, span, w) if released else from_begin(chi, w)
        root = w ** (1.0 / (n + 1.0)) - miss * g**-power * w**power / (n + 1.0)
        new = max(root, 0.0) ** (n + 1.0)
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - w) <= _PLACE_ROUNDING * w:
            return new
        w = new
    return w


@leaf_kernel
def rate_at(chi, e, span, w, released):
    """Return y = chi d'/v0 and 1 + y at w from an end of the contact, each without cancellation."""
    if not released:
        return chi + (1.0 + chi) * math.expm1(-w), (1.0 + chi) * math.exp(-w)
    push = (1.0 + chi) * math.exp(w - span)
    if w < 1.0:
        return (1.0 + chi) * math.exp(-span) * math.expm1(w) - e * chi, push
    return push - (1.0 + chi) * math.exp(-span) - e * chi, push


@kernel
def history(stiffness, exponent, chi, mass, speed, times, out):
    """Fill ``out`` (3, N) with indentation, its rate and the force at times from first touch to release."""
    n, chi = exponent, max(chi, _ELASTIC)
    span, turn = span_of_factor(chi), math.log1p(chi)
    e = restitution_of_span(span)
    unit = time_unit(stiffness, n, chi, mass, speed)
    whole = ((n + 1.0) * mass * speed**2 / (chi * chi * stiffness)) ** (1.0 / (n + 1.0))
    _, turned, end = moments(stiffness, n, chi, mass, speed)
    for i in range(times.size):
        released = times[i] > turned  # measured from the nearer end, where the integral keeps its digits
        integral = (end - times[i] if released else times[i]) / unit
        w, g = 0.0, 0.0
        if integral > 0.0:
            w = distance_at(n, chi, e, integral, span - turn if released else turn, released)
            g = max(from_end(chi, e, span, w) if released else from_begin(chi, w), 0.0)  # rounding at the ends
        y, push = rate_at(chi, e, span, w, released)
        depth = whole * g ** (1.0 / (n + 1.0))
        out[0, i], out[1, i], out[2, i] = depth, speed * y / chi, stiffness * depth**n * push


@kernel
def impacts(stiffness, exponent, chi, mass, speed, out):
    """Fill ``out`` (4, N) with restitution, indentation, force and duration of N impacts."""
    for i in range(stiffness.size):
        out[0, i], out[1, i], out[2, i], out[3, i] = impact(stiffness[i], exponent[i], chi[i], mass[i], speed[i])


@kernel
def factors(restitution, out):
    """Fill ``out`` with the hysteresis factors chi that give the restitutions asked for."""
    for i in range(restitution.size):
        out[i] = span_of_restitution(restitution[i]) / (1.0 + restitution[i])


@kernel
def restitutions(chi, out):
    """Fill ``out`` with the restitutions that the hysteresis factors give."""
    for i in range(chi.size):
        out[i] = restitution_of_span(span_of_factor(chi[i]))


def flat(*values):
    """Broadcast values to one shape and return them as flat float arrays, with that shape."""
    arrays = np.broadcast_arrays(*[np.asarray(v, dtype=float) for v in values])
    return [np.ascontiguousarray(a).reshape(-1) for a in arrays], arrays[0].shape
