"""Kernels of strain and stress in the rows of a chunk (`strikewave.fem._layout`): turned, elastic, plastic."""

import math

import numpy as np

from strikewave.base.compiled import fused_called_kernel, fused_leaf_kernel
from strikewave.fem._layout import (
    BACK,
    BILINEAR,
    HEAT,
    HEATING,
    HELD,
    ISOTROPIC,
    JC_A,
    JC_B,
    JC_C,
    JC_M,
    JC_N,
    JC_RANGE,
    JOHNSON_COOK,
    KINEMATIC,
    LAME,
    PLASTIC,
    RATE,
    ROOM,
    SHEAR,
    SIGMA,
    SIX,
    SPIN,
    STRAIN,
    STRAIN_P,
    STRESS,
    WORK,
    YIELD,
    ZA_C0,
    ZA_C1,
    ZA_C2,
    ZA_C3,
    ZA_C4,
    ZA_C5,
    ZA_N,
    ZERILLI_ARMSTRONG,
    W,
)

STILL = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""No back stress: the yield surface is centred on the origin."""
CLOSE = 1e-7
"""Share of a plastic strain increment; a step of Newton's method below it is the last.

The method squares its error, so that 1e-14 is left: the rounding of the increment."""
ITERATIONS = 100
"""Most steps of Newton's method: chosen far above what it takes, so that a solid of odd constants cannot hang a run."""
NEAR_LOW = 0.1
"""Share of the bracket, from its lower end, at which Newton's method begins again where it left the bracket.

The flow stress bends downward with the increment, so that the method converges from below, not from above."""
TINY = 1e-300
"""Keeps a division by zero out where there is no stress; no stress in Pa is as small."""


@fused_leaf_kernel
def turned(w0, w1, w2, xx, yy, zz, xy, yz, zx):
    """Return a symmetric tensor turned by the Cayley map of a rotation increment (Hughes & Winget 1980)."""
    k = 1.0 / (1.0 + 0.25 * (w0 * w0 + w1 * w1 + w2 * w2))
    h = 0.5 * k
    a, b, c = 1.0 - h * (w1 * w1 + w2 * w2), h * w0 * w1 - k * w2, h * w0 * w2 + k * w1
    d, e, f = h * w0 * w1 + k * w2, 1.0 - h * (w0 * w0 + w2 * w2), h * w1 * w2 - k * w0
    g, p, q = h * w0 * w2 - k * w1, h * w1 * w2 + k * w0, 1.0 - h * (w0 * w0 + w1 * w1)
    r11, r12, r13 = a * xx + b * xy + c * zx, a * xy + b * yy + c * yz, a * zx + b * yz + c * zz
    r21, r22, r23 = d * xx + e * xy + f * zx, d * xy + e * yy + f * yz, d * zx + e * yz + f * zz
    r31, r32, r33 = g * xx + p * xy + q * zx, g * xy + p * yy + q * yz, g * zx + p * yz + q * zz
    return (
        r11 * a + r12 * b + r13 * c,
        r21 * d + r22 * e + r23 * f,
        r31 * g + r32 * p + r33 * q,
        r11 * d + r12 * e + r13 * f,
        r21 * g + r22 * p + r23 * q,
        r31 * a + r32 * b + r33 * c,
    )


@fused_leaf_kernel
def increments(s, gradient, j):
    """Write the strain and rotation increment at the middle of the step, the strain as it lies at its end.

    The gradient G of the step's displacement is over the shape at its end; over the shape in its middle it is
    G (I - G / 2)^-1, whose symmetric part e vanishes for any rigid motion. By the end, where the stress is, that strain
    has turned by half the rotation W: e + (W e - e W) / 2, but for terms of third order in the step. Without it the
    stress would be of first order where the motion spins while it strains.
    """
    a, b, c, d, e, f, g, h, i = gradient
    A, B, C = 1.0 - 0.5 * a, -0.5 * b, -0.5 * c
    D, E, F = -0.5 * d, 1.0 - 0.5 * e, -0.5 * f
    P, Q, R = -0.5 * g, -0.5 * h, 1.0 - 0.5 * i
    m11, m12, m13 = E * R - F * Q, C * Q - B * R, B * F - C * E
    m21, m22, m23 = F * P - D * R, A * R - C * P, C * D - A * F
    m31, m32, m33 = D * Q - E * P, B * P - A * Q, A * E - B * D
    n = 1.0 / (A * m11 + B * m21 + C * m31)
    xx, yy = n * (a * m11 + b * m21 + c * m31), n * (d * m12 + e * m22 + f * m32)
    zz = n * (g * m13 + h * m23 + i * m33)
    xy, yx = n * (a * m12 + b * m22 + c * m32), n * (d * m11 + e * m21 + f * m31)
    yz, zy = n * (d * m13 + e * m23 + f * m33), n * (g * m12 + h * m22 + i * m32)
    zx, xz = n * (g * m11 + h * m21 + i * m31), n * (a * m13 + b * m23 + c * m33)
    w0, w1, w2 = 0.5 * (zy - yz), 0.5 * (xz - zx), 0.5 * (yx - xy)
    s[SPIN[0] + j], s[SPIN[1] + j], s[SPIN[2] + j] = w0, w1, w2
    xy, yz, zx = 0.5 * (xy + yx), 0.5 * (yz + zy), 0.5 * (zx + xz)
    about_x, about_y, about_z = w0 * yz, w1 * zx, w2 * xy
    s[STRAIN[0] + j] = xx + about_y - about_z
    s[STRAIN[1] + j] = yy + about_z - about_x
    s[STRAIN[2] + j] = zz + about_x - about_y
    s[STRAIN[3] + j] = xy + 0.5 * (w2 * (xx - yy) + w1 * yz - w0 * zx)
    s[STRAIN[4] + j] = yz + 0.5 * (w0 * (yy - zz) + w2 * zx - w1 * xy)
    s[STRAIN[5] + j] = zx + 0.5 * (w1 * (zz - xx) + w0 * xy - w2 * yz)


@fused_leaf_kernel
def turned_rows(s, rows, j):
    """Return a tensor of the state turned by the spin of the step."""
    return turned(
        s[SPIN[0] + j],
        s[SPIN[1] + j],
        s[SPIN[2] + j],
        s[HELD + rows[0] + j],
        s[HELD + rows[1] + j],
        s[HELD + rows[2] + j],
        s[HELD + rows[3] + j],
        s[HELD + rows[4] + j],
        s[HELD + rows[5] + j],
    )


@fused_leaf_kernel
def elastic(s, lame, shear, j):
    """Turn the stress with the material, add C : strain, and write stress and work."""
    xx, yy, zz, xy, yz, zx = turned_rows(s, SIGMA, j)
    a, b, c = s[STRAIN[0] + j], s[STRAIN[1] + j], s[STRAIN[2] + j]
    d, e, f = s[STRAIN[3] + j], s[STRAIN[4] + j], s[STRAIN[5] + j]
    bulk, twice = lame * (a + b + c), 2.0 * shear
    sxx, syy, szz = xx + bulk + twice * a, yy + bulk + twice * b, zz + bulk + twice * c
    sxy, syz, szx = xy + twice * d, yz + twice * e, zx + twice * f
    s[STRESS[0] + j], s[STRESS[1] + j], s[STRESS[2] + j] = sxx, syy, szz
    s[STRESS[3] + j], s[STRESS[4] + j], s[STRESS[5] + j] = sxy, syz, szx
    double = (xx + sxx) * a + (yy + syy) * b + (zz + szz) * c
    s[WORK + j] = 0.5 * double + (xy + sxy) * d + (yz + syz) * e + (zx + szx) * f


@fused_leaf_kernel
def direction(s, back, j):
    """Return the deviator of trial stress less back stress, and its von Mises stress q = sqrt(3/2 |.|^2)."""
    xx, yy, zz = s[STRESS[0] + j], s[STRESS[1] + j], s[STRESS[2] + j]
    mean = (xx + yy + zz) / 3.0
    a, b, c = xx - mean - back[0], yy - mean - back[1], zz - mean - back[2]
    d, e, f = s[STRESS[3] + j] - back[3], s[STRESS[4] + j] - back[4], s[STRESS[5] + j] - back[5]
    q = math.sqrt(1.5 * (a * a + b * b + c * c) + 3.0 * (d * d + e * e + f * f))
    return q, (a, b, c, d, e, f)


@fused_leaf_kernel
def flow(s, shear, n, share, j):
    """Take 2 G times a plastic strain increment 3/2 share n off the trial stress (radial return); write the works.

    Work is what the mean of the stresses before and after does, plastic work too: the rest is elastic energy, exactly.
    """
    cut = 3.0 * shear * share
    a, b, c, d, e, f = cut * n[0], cut * n[1], cut * n[2], cut * n[3], cut * n[4], cut * n[5]
    lost = a * s[STRAIN[0] + j] + b * s[STRAIN[1] + j] + c * s[STRAIN[2] + j]
    lost += 2.0 * (d * s[STRAIN[3] + j] + e * s[STRAIN[4] + j] + f * s[STRAIN[5] + j])
    s[STRESS[0] + j] -= a
    s[STRESS[1] + j] -= b
    s[STRESS[2] + j] -= c
    s[STRESS[3] + j] -= d
    s[STRESS[4] + j] -= e
    s[STRESS[5] + j] -= f
    done = (s[STRESS[0] + j] + 0.5 * a) * n[0] + (s[STRESS[1] + j] + 0.5 * b) * n[1]
    done += (s[STRESS[2] + j] + 0.5 * c) * n[2] + 2.0 * (s[STRESS[3] + j] + 0.5 * d) * n[3]
    done += 2.0 * (s[STRESS[4] + j] + 0.5 * e) * n[4] + 2.0 * (s[STRESS[5] + j] + 0.5 * f) * n[5]
    s[WORK + j] -= 0.5 * lost
    s[PLASTIC + j] = 1.5 * share * done - 0.5 * lost


@fused_leaf_kernel
def von_mises(s, back, solid, j):
    """Return the trial stress to the yield surface, exact for linear hardening; return the shift of the back stress.

    dp = (q - sigma_y - H p) / (3 G + H), q the von Mises stress of trial stress less back stress.
    """
    isotropic, kinematic, shear = solid[ISOTROPIC], solid[KINEMATIC], solid[SHEAR]
    q, n = direction(s, back, j)
    excess = q - solid[YIELD] - isotropic * s[HELD + STRAIN_P + j]
    dp = max(excess, 0.0) / (3.0 * shear + isotropic + kinematic)  # without a branch: a vector loop
    share = dp / max(q, TINY)  # 0/0 where there is neither stress nor flow
    flow(s, shear, n, share, j)
    s[HELD + STRAIN_P + j] += dp
    shift = kinematic * share
    return shift * n[0], shift * n[1], shift * n[2], shift * n[3], shift * n[4], shift * n[5]


@fused_leaf_kernel
def johnson_cook_still(solid, p, heat):
    """Return the flow stress at the reference rate, and the softening 1 - T*^m."""
    warm = heat / solid[JC_RANGE]
    # no negative strength beyond melting; below room temperature the law says nothing
    softening = 1.0 - min(warm, 1.0) ** solid[JC_M] if warm > 0.0 else 1.0
    return softening * (solid[JC_A] + solid[JC_B] * p ** solid[JC_N]), softening


@fused_leaf_kernel
def johnson_cook_flow(solid, p, dp, softening, dt):
    """Return softening (A + B (p + dp)^n) (1 + C ln(max(dp / dt, rate) / rate)), and its slope over dp."""
    slowest = solid[RATE] * dt  # below the reference rate the logarithm would fall without end
    hard = solid[JC_B] * (p + dp) ** solid[JC_N]
    fast = 1.0 + solid[JC_C] * math.log(max(dp / slowest, 1.0))
    cold, steeper = solid[JC_A] + hard, solid[JC_C] / dp if dp > slowest else 0.0
    return softening * cold * fast, softening * (hard * solid[JC_N] / (p + dp) * fast + cold * steeper)


@fused_leaf_kernel
def zerilli_armstrong_still(solid, p, heat):
    """Return the flow stress at the reference rate, and the temperature in kelvin."""
    temperature = solid[ROOM] + heat
    active = math.exp(-solid[ZA_C3] * temperature) * (solid[ZA_C1] + solid[ZA_C2] * math.sqrt(p))
    return solid[ZA_C0] + active + solid[ZA_C5] * p ** solid[ZA_N], temperature


@fused_leaf_kernel
def zerilli_armstrong_flow(solid, p, dp, temperature, dt):
    """Return C0 + (C1 + C2 sqrt(p)) exp(T (C4 ln(max(dp / dt, rate) / rate) - C3)) + C5 p^n at p + dp, and slope."""
    slowest, strain = solid[RATE] * dt, p + dp
    root = solid[ZA_C2] * math.sqrt(strain)
    hard = solid[ZA_C5] * strain ** solid[ZA_N]
    active = math.exp(temperature * (solid[ZA_C4] * math.log(max(dp / slowest, 1.0)) - solid[ZA_C3]))
    steeper = temperature * solid[ZA_C4] / dp if dp > slowest else 0.0
    slope = active * (0.5 * root / strain + (solid[ZA_C1] + root) * steeper) + hard * solid[ZA_N] / strain
    return solid[ZA_C0] + active * (solid[ZA_C1] + root) + hard, slope


@fused_leaf_kernel
def plastic_increment(law, q, p, thermal, solid, dt, guess):
    """Return dp where q - 3 G dp is the flow stress of a law at p + dp and the rate dp / dt, q beyond yield.

    The left falls and the right grows: Newton's method; where it leaves the bracket, a place near its lower end, from
    which it converges.
    """
    stiff = 3.0 * solid[SHEAR]
    low, high = 0.0, q / stiff
    dp = guess
    for _ in range(ITERATIONS):
        stress, slope = law(solid, p, dp, thermal, dt)
        off = q - stiff * dp - stress
        if off > 0.0:
            low = dp
        else:
            high = dp
        step = off / (stiff + slope)
        if abs(step) <= CLOSE * dp:
            return dp + step
        dp = dp + step if low < dp + step < high else (1.0 - NEAR_LOW) * low + NEAR_LOW * high
    return dp


@fused_leaf_kernel
def heated_flow(still_law, law, s, solid, dt, j):
    """Return the trial stress to the yield surface of a law of rate and temperature; heat the solid by plastic work."""
    q, n = direction(s, STILL, j)
    if q <= 0.0:
        return
    p, stiff = s[HELD + STRAIN_P + j], 3.0 * solid[SHEAR]
    still, thermal = still_law(solid, p, s[HELD + HEAT + j])
    excess = q - still
    if excess <= 0.0:
        return
    dp = q / stiff
    if still > 0.0:  # else no strength is left, and all of the deviator goes
        along = n[0] * s[STRAIN[0] + j] + n[1] * s[STRAIN[1] + j] + n[2] * s[STRAIN[2] + j]
        along += 2.0 * (n[3] * s[STRAIN[3] + j] + n[4] * s[STRAIN[4] + j] + n[5] * s[STRAIN[5] + j])
        # the rate hardens: no more plastic strain than the step's strain along the flow is a nearer begin
        guess = min(excess / stiff, along / q) if along > 0.0 else excess / stiff
        dp = plastic_increment(law, q, p, thermal, solid, dt, guess)
    flow(s, solid[SHEAR], n, dp / q, j)
    s[HELD + STRAIN_P + j] += dp
    s[HELD + HEAT + j] += solid[HEATING] * s[PLASTIC + j]  # after the flow: strength of a step is that of its begin


@fused_called_kernel
def johnson_cook(s, solid, dt, j):
    """Apply the law of Johnson & Cook to the trial stress."""
    heated_flow(johnson_cook_still, johnson_cook_flow, s, solid, dt, j)


@fused_called_kernel
def zerilli_armstrong(s, solid, dt, j):
    """Apply the law of Zerilli & Armstrong to the trial stress."""
    heated_flow(zerilli_armstrong_still, zerilli_armstrong_flow, s, solid, dt, j)


@fused_leaf_kernel
def moving_yield(s, solid, j):
    """Return the trial stress to a yield surface that moves, and move it."""
    back = turned_rows(s, BACK, j)
    shift = von_mises(s, back, solid, j)
    for k in range(6):
        s[HELD + BACK[0] + np.uint64(k) * W + j] = back[k] + shift[k]


@fused_leaf_kernel
def hold_stress(s, j):
    """Keep the stress of the end of the step."""
    for k in range(SIX):
        s[HELD + SIGMA[0] + k * W + j] = s[STRESS[0] + k * W + j]


@fused_called_kernel
def update_stress(s, solid, kind, dt):
    """Bring the stress of a chunk to the end of the step; writes rows STRESS, WORK and PLASTIC and the held state.

    A loop for each law, so that those without branches become vector loops; `stress_of_one` does the same for one lane.
    """
    lame, shear = solid[LAME], solid[SHEAR]
    for j in range(W):
        elastic(s, lame, shear, j)
        s[PLASTIC + j] = 0.0
    if kind == JOHNSON_COOK:
        for j in range(W):
            johnson_cook(s, solid, dt, j)
    elif kind == ZERILLI_ARMSTRONG:
        for j in range(W):
            zerilli_armstrong(s, solid, dt, j)
    elif kind == BILINEAR and solid[KINEMATIC] == 0.0:
        for j in range(W):
            von_mises(s, STILL, solid, j)
    elif kind == BILINEAR:
        for j in range(W):
            moving_yield(s, solid, j)
    for j in range(SIX * W):
        s[HELD + SIGMA[0] + j] = s[STRESS[0] + j]


@fused_leaf_kernel
def stress_of_one(s, solid, kind, dt, j):
    """Bring the stress of one lane to the end of the step, as `update_stress` does for a chunk."""
    elastic(s, solid[LAME], solid[SHEAR], j)
    s[PLASTIC + j] = 0.0
    if kind == JOHNSON_COOK:  # the kinds outside of any loop here: a thread of a device has one lane
        johnson_cook(s, solid, dt, j)
    elif kind == ZERILLI_ARMSTRONG:
        zerilli_armstrong(s, solid, dt, j)
    elif kind == BILINEAR and solid[KINEMATIC] == 0.0:
        von_mises(s, STILL, solid, j)
    elif kind == BILINEAR:
        moving_yield(s, solid, j)
    hold_stress(s, j)
