"""Compiled first mode of a round bar: the Pochhammer-Chree equation, followed along a path of frequencies.

With W = (w a/c0)^2, x = (k c0/w)^2 = (c0/c)^2, s = 2 (1 + nu) = (c0/c2)^2, r = (1 + nu)(1 - 2 nu)/(1 - nu) = (c0/c1)^2
and phi(z^2) = z J0(z)/J1(z) the equation has no square roots:

    g = 2 s (r - x) - (s - 2 x)^2 phi(W (r - x)) - 4 x (r - x) phi(W (s - x)) = 0
"""

import numpy as np

from strikewave.base.compiled import kernel, leaf_kernel

LONGEST_STEP = 0.05
"""Longest step of the path, in units of w a/c0 or k a. Steps of twice this length go over to another mode in a bar of
Poisson's ratio 0.05 (measured), where two modes nearly touch."""
_SHORT_WAVES = 0.1
"""Inverse of the w a/c0 above which the longest step grows with it: the mode of short waves hardly bends any more."""
SETTLED = 1e-9
"""Relative change by a Newton step after which the next one would be below rounding: its error is the square."""
_ITERATIONS = 30
"""Newton steps at most; a step of the path begins so near that a few do."""
LARGE = 1e100
"""Size at which numerator and denominator of the continued fraction are made small again: a product of two such numbers
still is no overflow."""
_LEAST_TERMS, _TERMS = 12, 0.75
"""Terms of the continued fraction, and terms per |z|: exact to rounding for |z| below 5 and for z near the imaginary
axis, where waves that are short beside the radius lie (measured against mpmath)."""


@leaf_kernel
def bessel_share(w):
    """Return q = (2 - phi)/w, phi(w) = z J0(z)/J1(z), w = z^2, by the continued fraction 1/(4 - w/(6 - w/(8 - ..))).

    From the far end on, with top/bottom = u_n = 1 - w/(4 n (n + 1))/u_(n + 1), so that only real numbers are divided.
    Both grow like exp(|Im z|), and are made small again before they overflow.
    """
    terms = _LEAST_TERMS + int(_TERMS * np.sqrt(abs(w)))
    share = 0.25 * w
    top = bottom = 1.0 + 0.0j
    for n in range(terms + 2, 1, -1):
        top, bottom = top - share * (1.0 / (n * (n + 1))) * bottom, top
        if abs(top.real) > LARGE or abs(top.imag) > LARGE:
            top, bottom = top / LARGE, bottom / LARGE
    return 0.25 * bottom / top


@leaf_kernel
def characteristic(W, x, s, r):
    """Return g and its derivatives by x and by W; phi' = (phi q - 1)/2."""
    a, b = r - x, s - x
    qa, qb = bessel_share(W * a), bessel_share(W * b)
    pa, pb = 2.0 - W * a * qa, 2.0 - W * b * qb
    da, db = 0.5 * (pa * qa - 1.0), 0.5 * (pb * qb - 1.0)
    c = s - 2.0 * x
    g = 2.0 * s * a - c * c * pa - 4.0 * x * a * pb
    by_x = -2.0 * s + 4.0 * c * pa + c * c * W * da + 4.0 * (x - a) * pb + 4.0 * x * a * W * db
    by_W = -c * c * a * da - 4.0 * x * a * b * db
    return g, by_x, by_W


@kernel
def follow_frequency(omega, s, r):
    """Return x = (c0/c)^2 and dx/dW of the first mode at w a/c0 = omega (complex, in an order without jumps)."""
    x, slope = np.empty(omega.size, np.complex128), np.empty(omega.size, np.complex128)
    here, ratio, rate = 0.0j, 1.0 + 0.0j, 0.0j
    for i in range(omega.size):
        longest = LONGEST_STEP * max(1.0, _SHORT_WAVES * abs(here))
        begin, steps = here, int(abs(omega[i] - here) / longest) + 1
        for k in range(1, steps + 1):
            there = begin + (omega[i] - begin) * (k / steps)
            W = there * there
            ratio += rate * (W - here * here)  # along the slope: the next root is near, and no other mode is
            for _ in range(_ITERATIONS):
                g, by_x, by_W = characteristic(W, ratio, s, r)
                change = g / by_x
                ratio -= change
                if abs(change) <= SETTLED * abs(ratio):
                    break
            rate, here = -by_W / by_x, there
        x[i], slope[i] = ratio, rate
    return x, slope


@kernel
def follow_wavelength(ka, s, r):
    """Return (c/c0)^2 of the first mode at real k a, rising."""
    squares = np.empty(ka.size)
    here, y = 0.0, 1.0
    for i in range(ka.size):
        begin, steps = here, int((ka[i] - here) / LONGEST_STEP) + 1
        for k in range(1, steps + 1):
            here = begin + (ka[i] - begin) * (k / steps)
            for _ in range(_ITERATIONS):
                W, x = here * here * y + 0.0j, 1.0 / y + 0.0j
                g, by_x, by_W = characteristic(W, x, s, r)
                # d/dy at fixed k a, where W and x both change with y
                change = (g / (by_W * here * here - by_x * x * x)).real
                y -= change
                if abs(change) <= SETTLED * y:
                    break
        squares[i] = y
    return squares
