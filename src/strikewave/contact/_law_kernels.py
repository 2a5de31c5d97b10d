"""Compiled force laws of a contact, one row of numbers a law.

The base is elastic: F = K d^n, the logarithmic law of line contacts d = (F/G) ln(B/F), or a cushion that hardens
towards a limit (`hardening`; the laws: `strikewave.contact.cushions`). On it stand

- hysteresis, F (1 + chi d'/v0),
- or a damper, F + c d^p d', or retarded by a time c, F + c F'(d) d',
- and a cap: beyond the yield load F_y the force is F_y f(q), q = F/F_y, where the Hertz pressure is cut off at its
  value at first yield (`strikewave.contact.elastoplastic`), or where a cushion crushes.

What has yielded to the depth D unloads elastically with the radius s R, s = q/f(q) at D. By similarity that is
F(s (d - d_r))/s with d_r = D (1 - 1/s), whatever the base. D is all that a contact remembers; s is kept beside it
because it is costly to find. Where nothing has yielded s is 1, and all of this is the elastic base.
"""

import math

import numpy as np

from strikewave.base.compiled import called_kernel, leaf_kernel

(
    OFFSET,
    STIFFNESS,
    EXPONENT,
    DAMPING,
    PRELOAD,
    SLOWEST,
    FORM,
    DAMPER,
    DAMPER_EXPONENT,
    STYLE,
    YIELD_LOAD,
    SHAPE,
    SPOT,
    LIMIT,
) = range(14)
"""Places in a row, SI. Of a logarithmic base, STIFFNESS holds G and EXPONENT holds B; of a cushion with a plateau
EXPONENT holds its force, and LIMIT is the depth that a cushion never reaches. DAMPING is chi of a contact, or c of a
spring or stop. Contacts of one SPOT above zero share what has yielded."""
COLUMNS = 14
"""Length of a row: the places above."""

NO_DEPTH = 1e-30
"""Divisor in place of a depth of zero, m: far below every indentation, far above underflow."""
_SAME_AS_ELASTIC = 1e-12
"""Share beyond the yield load that counts as not yielded: the rounding of the depth at yield, found by a root."""
_LOGARITHM_STEPS, _ROUNDING = 30, 1e-15
"""Newton steps for w and the relative change that ends them: a few of the last bits. Near the end of the law, w = 1,
the last bits never settle, and the cap ends it."""
_DEPTH_STEPS = 60
"""Newton steps for the depth of an energy: far more than convergence takes, so that only halving steps need them."""

POWER, LOGARITHMIC, TANGENT, ELASTOMER, PLATEAU = 0.0, 1.0, 2.0, 3.0, 4.0
"""Values of FORM."""
NEVER_PULLS, ON_APPROACH, PULLS, RETARDED = 0.0, 1.0, 2.0, 3.0
"""Values of STYLE: how the damper acts."""
LINE, POINT, CRUSH = 0.0, 1.0, 2.0
"""Values of SHAPE."""
FOLLOWED = 0.99
"""Share of its limit to which the law of a cushion is followed; beyond, its force goes straight on, so that steps that
reach too far find a force. Chosen: there the laws bear forty times their plateau or more, and no cushion is known."""
STEEPNESS = 2.3
"""D of Gibson & Ashby: densification begins at the share 1 - 1/D of its limit."""


@called_kernel
def logarithm(law, d):
    """Return w = ln(B/F) of the logarithmic law: the root of w - ln w = ln(B/(G d)) above 1, by Newton steps.

    Beyond the depth B/(G e), where the law ends, w stays 1.
    """
    c = math.log(law[EXPONENT] / (law[STIFFNESS] * d))
    if c <= 1.0:
        return 1.0
    w = c + math.log(c + math.log(c + 1.0))
    for _ in range(_LOGARITHM_STEPS):
        step = (w - math.log(w) - c) * w / (w - 1.0)
        w -= step
        if abs(step) <= _ROUNDING * w:
            break
    return w


@called_kernel
def hardening(law, d):
    """Return force, slope and energy of a cushion that hardens towards its limit, N, N/m, J.

    With k the slope at first touch and L the limit,

    - tangent: F = (2 k L/pi) tan(pi d/(2 L)),
    - elastomer: F = (k L/3) (1/w^2 - w), w = 1 - d/L,
    - plateau: k d up to the force P, P up to L (1 - 1/D), then (P/D) L/(L - d).
    """
    k, limit = law[STIFFNESS], law[LIMIT]
    x = min(d, FOLLOWED * limit)
    if law[FORM] == TANGENT:
        rate = 0.5 * math.pi / limit
        rise = math.tan(rate * x)
        force, slope, energy = k * rise / rate, k * (1.0 + rise * rise), 0.5 * k * math.log1p(rise * rise) / rate**2
    elif law[FORM] == ELASTOMER:
        # u = 1/w: the differences are written so that nothing cancels at first touch
        u = 1.0 / (1.0 - x / limit)
        force, slope = k * x * (u * u + u + 1.0) / 3.0, k * (2.0 * u**3 + 1.0) / 3.0
        energy = k * x * x * (u + 0.5) / 3.0
    else:
        plateau = law[EXPONENT]
        begin, end = plateau / k, limit * (1.0 - 1.0 / STEEPNESS)
        if x <= begin:
            force, slope, energy = k * x, k, 0.5 * k * x * x
        elif x <= end:
            force, slope, energy = plateau, 0.0, plateau * (x - 0.5 * begin)
        else:
            r = limit / (limit - x)
            force, slope = plateau * r / STEEPNESS, plateau * r * r / (STEEPNESS * limit)
            energy = plateau * (end - 0.5 * begin + limit * math.log(r / STEEPNESS) / STEEPNESS)
    over = d - x  # beyond the followed part, straight on: trial steps may reach farther than any motion
    return force + slope * over, slope, energy + (force + 0.5 * slope * over) * over


@leaf_kernel
def base_force(law, d):
    """Return the elastic force at an indentation, N; zero apart."""
    if d <= 0.0:
        return 0.0
    if law[FORM] == POWER:
        return law[STIFFNESS] * d ** law[EXPONENT]
    if law[FORM] == LOGARITHMIC:
        return law[STIFFNESS] * d / logarithm(law, d)
    return hardening(law, d)[0]


@leaf_kernel
def base_slope(law, d):
    """Return dF/dd of the elastic base, N/m."""
    if d <= 0.0:
        return 0.0
    if law[FORM] == POWER:
        return law[EXPONENT] * law[STIFFNESS] * d ** (law[EXPONENT] - 1.0)
    if law[FORM] == LOGARITHMIC:
        return law[STIFFNESS] / (logarithm(law, d) - 1.0)
    return hardening(law, d)[1]


@leaf_kernel
def base_energy(law, d):
    """Return the energy that the elastic base stores, J: F d/(n + 1), or F^2 (2 w - 1)/(4 G)."""
    if d <= 0.0:
        return 0.0
    if law[FORM] == POWER:
        return law[STIFFNESS] * d ** (law[EXPONENT] + 1.0) / (law[EXPONENT] + 1.0)
    if law[FORM] == LOGARITHMIC:
        w = logarithm(law, d)
        return law[STIFFNESS] * d * d * (2.0 * w - 1.0) / (4.0 * w * w)
    return hardening(law, d)[2]


@called_kernel
def crushed(law, q):
    """Return f(q) and f'(q) of a cushion that crushes, q the depth over that at yield; see `hardening` for its plateau.

    It densifies until it is as steep as at first touch, r = (D q_L)^(1/2), and is elastic from there on.
    """
    limit = law[LIMIT] * law[STIFFNESS] / law[YIELD_LOAD]
    if q <= limit * (1.0 - 1.0 / STEEPNESS):
        return 1.0, 0.0
    steepest = math.sqrt(STEEPNESS * limit)
    last = limit * (1.0 - 1.0 / steepest)
    if q >= last:  # as steep as it unloads: a steeper crush would give back more than it takes
        return steepest / STEEPNESS + q - last, 1.0
    r = limit / (limit - q)
    return r / STEEPNESS, r * r / (STEEPNESS * limit)


@leaf_kernel
def capped(law, q):
    """Return f(q) and f'(q): the force over the yield load, for the elastic force q over the yield load, q >= 1.

    Line: f = (2/pi) [q asin(1/sqrt(q)) + sqrt(q - 1)]. Point: f = 3/2 q^(2/3) - 1/2. Crush: `crushed`.
    """
    if law[SHAPE] == CRUSH:
        return crushed(law, q)
    if law[SHAPE] == POINT:
        root = np.cbrt(q)
        return 1.5 * root * root - 0.5, 1.0 / root
    angle = math.asin(1.0 / math.sqrt(q))
    return (q * angle + math.sqrt(q - 1.0)) * 2.0 / math.pi, angle * 2.0 / math.pi


@leaf_kernel
def flattening(law, deepest):
    """Return s >= 1, the radius after yielding to the depth D over the radius before; 1 where nothing yields."""
    q = base_force(law, deepest) / law[YIELD_LOAD]
    return q / capped(law, q)[0] if q > 1.0 + _SAME_AS_ELASTIC else 1.0


@leaf_kernel
def residual(deepest, s):
    """Return the depth d_r = D (1 - 1/s) that stays when the force is gone, m."""
    return deepest * (1.0 - 1.0 / s)


@called_kernel
def yielding(law, d):
    """Return the force at the depth d while it yields, its slope, and the rate at which it stores energy, N, N/m, N.

    The energy that comes back is W/s^2 with W that of the base.
    """
    elastic, slope = base_force(law, d), base_slope(law, d)
    f, df = capped(law, max(elastic / law[YIELD_LOAD], 1.0))  # below yield by the rounding of its depth only
    force, rise = law[YIELD_LOAD] * f, df * slope
    s = elastic / force
    ds = (slope * force - elastic * rise) / (force * force)
    return force, rise, elastic / (s * s) - 2.0 * base_energy(law, d) * ds / s**3


@leaf_kernel
def unyielding(law, d, deepest, s):
    """Return the force at the depth d after yielding to the depth D >= d, and its slope, N and N/m."""
    depth = s * d - deepest * (s - 1.0)
    return base_force(law, depth) / s, base_slope(law, depth)


@leaf_kernel
def unyielding_force(law, d, deepest, s):
    """Return the force alone of `unyielding`."""
    return base_force(law, s * d - deepest * (s - 1.0)) / s


@called_kernel
def stored(law, d, deepest):
    """Return the energy that a contact at the depth d gives back, after yielding to the depth D, J."""
    reached = max(deepest, d)  # at a depth beyond, it is yielding on
    s = flattening(law, reached)
    return base_energy(law, s * d - reached * (s - 1.0)) / (s * s)


@leaf_kernel
def hysteresis(law, rate, approach):
    """Return 1 + chi d'/v0."""
    return 1.0 + law[DAMPING] * rate / max(approach, law[SLOWEST])


@leaf_kernel
def damper_force(law, d, rate):
    """Return c d^p d', or c F'(d) d' where the style is `RETARDED`, N; on approach only where it is `ON_APPROACH`."""
    # d^p has no value below zero
    if law[DAMPER] == 0.0 or d < 0.0 or (law[STYLE] == ON_APPROACH and rate < 0.0):
        return 0.0
    if law[STYLE] == RETARDED:
        return law[DAMPER] * base_slope(law, d) * rate
    return law[DAMPER] * d ** law[DAMPER_EXPONENT] * rate


@leaf_kernel
def push(law, d, rate, approach):
    """Return the force over its elastic part; where it falls through zero the force is lost."""
    if law[DAMPER] == 0.0:
        return hysteresis(law, rate, approach)
    if law[STYLE] == PULLS:  # its force is never lost
        return 1.0
    d = max(d, NO_DEPTH)
    return 1.0 + damper_force(law, d, rate) / base_force(law, d)


@leaf_kernel
def depth_at_yield(law):
    """Return the indentation at the yield load, m; zero where there is none."""
    load = law[YIELD_LOAD]
    if load == np.inf:  # a law without a cap counts as yielded to 0 m
        return 0.0
    if law[FORM] == POWER:
        return (load / law[STIFFNESS]) ** (1.0 / law[EXPONENT])
    return load / law[STIFFNESS] * math.log(law[EXPONENT] / load)


@called_kernel
def cushion_depth(law, energy):
    """Return the indentation at which a cushion holds an energy, m: Newton steps, halving where one leaves the bracket.

    It is no deeper than a linear one, and beyond its plateau's begin no deeper than one that stays on it.
    """
    low, high = 0.0, math.sqrt(2.0 * energy / law[STIFFNESS])
    if law[FORM] == PLATEAU:
        high = max(high, energy / law[EXPONENT] + 0.5 * law[EXPONENT] / law[STIFFNESS])
    d = high
    for _ in range(_DEPTH_STEPS):
        force, _, stored_there = hardening(law, d)
        if stored_there > energy:
            high = d
        else:
            low = d
        new = d - (stored_there - energy) / force
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - d) <= _ROUNDING * d:
            break
        d = new
    return d


@leaf_kernel
def elastic_depth(law, energy):
    """Return the indentation at which the elastic base holds an energy, m (Newton steps but for the power law)."""
    if law[FORM] == POWER:
        n = law[EXPONENT]
        return ((n + 1.0) * energy / law[STIFFNESS]) ** (1.0 / (n + 1.0))
    if law[FORM] != LOGARITHMIC:
        return cushion_depth(law, energy)
    end = law[EXPONENT] / law[STIFFNESS] / math.e
    if energy >= base_energy(law, end):
        return end
    # the energy is about G d^2/(2 w), and w = ln(B/F) below 20 for any force above 1e-9 B: Newton steps on a convex
    # function that begin above the root never pass it
    d = min(math.sqrt(40.0 * energy / law[STIFFNESS]), end)
    for _ in range(_DEPTH_STEPS):
        new = d - (base_energy(law, d) - energy) / base_force(law, d)
        if not 0.0 < new <= end:
            new = 0.5 * d
        if abs(new - d) <= _ROUNDING * d:
            break
        d = new
    return d
