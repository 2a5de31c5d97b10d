"""Adaptive integration with located switches: DOP853, compiled, for any system of the protocol below.

A system is a NamedTuple of arrays. Its module teaches the five functions below to it with
``numba.extending.overload``; the compiler then picks them by the system's type:

- ``derivatives(system, t, y, mode, memory, dy)`` fills dy/dt,
- ``forces(system, t, y, mode, memory, out)`` fills the force of each link,
- ``switches(system, t, y, mode, memory, g)`` fills functions that are positive while the mode holds,
- ``horizon(system, t, y, mode, memory)`` returns the largest step worth trying, s: a step that would be rejected,
  because something that is not smooth lies ahead, is never made,
- ``switch(system, k, t, y, mode, memory)`` changes the mode when g[k] falls below zero and returns
  CONTINUE, RESTART (the motion is not smooth here: begin with a small step) or STOP.

``mode`` (integers) and ``memory`` (floats) hold what changes at switches only. A step never runs
across a switch: the switch is found on the dense output, and the step is taken anew up to it.

Coefficients of the Dormand-Prince method of order 8(5,3) with dense output of order 7.

Source: E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed.,
Springer 1993, sections II.5-II.6 and the authors' program DOP853 (BSD); the digits are those of
scipy.integrate (BSD-3). The tests check the order conditions.
"""

import math
import re
from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import called_kernel, inner_kernel, kernel, leaf_kernel

STAGES = 12
"""Stages of one step; the dense output takes three more."""


def _table(rows, columns, text):
    """Return a table of which a text holds the numbers that are not zero: ``row: column number, column number, ..``."""
    table = np.zeros((rows, columns))
    for line in re.split(r"\s*(?=\b\d+:)", text.strip()):
        row, _, pairs = line.partition(":")
        for pair in filter(None, pairs.split(",")):
            column, number = pair.split()
            table[int(row), int(column)] = float(number)
    return table


A = _table(
    16,
    16,
    """
    1: 0 0.05260015195876773
    2: 0 0.0197250569845379, 1 0.0591751709536137
    3: 0 0.02958758547680685, 2 0.08876275643042054
    4: 0 0.2413651341592667, 2 -0.8845494793282861, 3 0.924834003261792
    5: 0 0.037037037037037035, 3 0.17082860872947386, 4 0.12546768756682242
    6: 0 0.037109375, 3 0.17025221101954405, 4 0.06021653898045596, 5 -0.017578125
    7: 0 0.03709200011850479, 3 0.17038392571223998, 4 0.10726203044637328, 5 -0.015319437748624402,
       6 0.008273789163814023
    8: 0 0.6241109587160757, 3 -3.3608926294469414, 4 -0.868219346841726, 5 27.59209969944671, 6 20.154067550477894,
       7 -43.48988418106996
    9: 0 0.47766253643826434, 3 -2.4881146199716677, 4 -0.590290826836843, 5 21.230051448181193, 6 15.279233632882423,
       7 -33.28821096898486, 8 -0.020331201708508627
    10: 0 -0.9371424300859873, 3 5.186372428844064, 4 1.0914373489967295, 5 -8.149787010746927, 6 -18.52006565999696,
        7 22.739487099350505, 8 2.4936055526796523, 9 -3.0467644718982196
    11: 0 2.273310147516538, 3 -10.53449546673725, 4 -2.0008720582248625, 5 -17.9589318631188, 6 27.94888452941996,
        7 -2.8589982771350235, 8 -8.87285693353063, 9 12.360567175794303, 10 0.6433927460157636
    12: 0 0.054293734116568765, 5 4.450312892752409, 6 1.8915178993145003, 7 -5.801203960010585, 8 0.3111643669578199,
        9 -0.1521609496625161, 10 0.20136540080403034, 11 0.04471061572777259
    13: 0 0.056167502283047954, 6 0.25350021021662483, 7 -0.2462390374708025, 8 -0.12419142326381637,
        9 0.15329179827876568, 10 0.00820105229563469, 11 0.007567897660545699, 12 -0.008298
    14: 0 0.03183464816350214, 5 0.028300909672366776, 6 0.053541988307438566, 7 -0.05492374857139099,
        10 -0.00010834732869724932, 11 0.0003825710908356584, 12 -0.00034046500868740456, 13 0.1413124436746325
    15: 0 -0.42889630158379194, 5 -4.697621415361164, 6 7.683421196062599, 7 4.06898981839711, 8 0.3567271874552811,
        12 -0.0013990241651590145, 13 2.9475147891527724, 14 -9.15095847217987
    """,
)
"""Weights of the earlier stages, row s for stage s; rows 13 to 15 belong to the dense output."""
B = A[12, :STAGES].copy()  # the stage at the end of the step is the step itself
"""Weights of the step of order 8."""
C, E3, E5 = _table(
    3,
    16,
    """
    0: 1 0.05260015195876773, 2 0.0789002279381516, 3 0.1183503419072274, 4 0.2816496580927726, 5 0.3333333333333333,
       6 0.25, 7 0.3076923076923077, 8 0.6512820512820513, 9 0.6, 10 0.8571428571428571, 11 1.0, 12 1.0, 13 0.1,
       14 0.2, 15 0.7777777777777778
    1: 0 -0.18980075407240762, 5 4.450312892752409, 6 1.8915178993145003, 7 -5.801203960010585, 8 -0.4226823213237919,
       9 -0.1521609496625161, 10 0.20136540080403034, 11 0.02265179219836082
    2: 0 0.01312004499419488, 5 -1.2251564463762044, 6 -0.4957589496572502, 7 1.6643771824549864,
       8 -0.35032884874997366, 9 0.3341791187130175, 10 0.08192320648511571, 11 -0.022355307863886294
    """,
)
"""Times of the stages within the step; weights of the error estimates of orders 3 and 5, of 13 stages."""
D = _table(
    4,
    16,
    """
    0: 0 -8.428938276109013, 5 0.5667149535193777, 6 -3.0689499459498917, 7 2.38466765651207, 8 2.117034582445028,
       9 -0.871391583777973, 10 2.2404374302607883, 11 0.6315787787694688, 12 -0.08899033645133331,
       13 18.148505520854727, 14 -9.194632392478356, 15 -4.436036387594894
    1: 0 10.427508642579134, 5 242.28349177525817, 6 165.20045171727028, 7 -374.5467547226902, 8 -22.113666853125306,
       9 7.733432668472264, 10 -30.674084731089398, 11 -9.332130526430229, 12 15.697238121770845,
       13 -31.139403219565178, 14 -9.35292435884448, 15 35.81684148639408
    2: 0 19.985053242002433, 5 -387.0373087493518, 6 -189.17813819516758, 7 527.8081592054236, 8 -11.57390253995963,
       9 6.8812326946963, 10 -1.0006050966910838, 11 0.7777137798053443, 12 -2.778205752353508, 13 -60.19669523126412,
       14 84.32040550667716, 15 11.99229113618279
    3: 0 -25.69393346270375, 5 -154.18974869023643, 6 -231.5293791760455, 7 357.6391179106141, 8 93.40532418362432,
       9 -37.45832313645163, 10 104.0996495089623, 11 29.8402934266605, 12 -43.53345659001114, 13 96.32455395918828,
       14 -39.17726167561544, 15 -149.72683625798564
    """,
)
"""Weights of the upper coefficients of the dense output."""

CONTINUE, RESTART, STOP = 0, 1, 2
"""Answers of a switch: go on, begin with a small step, or stop."""
END, STOPPED, FULL, STUCK = 0, 1, 2, 3
"""Reasons for which `advance` comes back: end, stopping switch, full record, no step small enough."""

_SAMPLES = 4
"""Samples of the switch functions in a step. Each costs one evaluation of the dense output; a dip between two of them
is found from the parabola through three (`_dip`)."""
_DEEP_DIP = 0.25
"""A parabola whose lowest point is below this share of the least of its samples is looked at. Chosen: well above 0,
since the parabola only estimates the dip."""
_SAFETY = 0.9
"""Share of the step that the error estimate allows, as in the authors' code of DOP853 (Hairer, Norsett & Wanner 1993):
a step at the very limit would often be rejected."""
_SMALLEST, _LARGEST = 0.2, 6.0
"""Factors between which a step changes: one estimate far off must not carry the step too far. 6 is that of the authors'
code of DOP853, 0.2 that of their DOPRI5."""
_ORDER = 8.0
"""The error of a step grows with this power of the step: by it the next one is chosen."""
_IDLE_LIMIT = 100
"""Switches in a row without progress in time after which the motion is given up: as many links may switch at one
instant, but two that switch each other would do so forever."""
_EXTENDED = 16
"""Stages of a step with its dense output: 12 and the end of the step, and three more."""
_FEW_STATES = 4
"""States up to which a sum of stages runs over the stages inside: the longer loop shall be the inner one, and a step
has 12 stages, many of whose weights are zero."""
_ROOT_STEPS, _ROOT_ROUNDING = 200, 4e-16
"""Illinois steps for a switch, and the width of its bracket, as a share of the step, that ends them: two of the last
bits. Halving alone would take 52 steps, the rule takes far fewer; the cap only guards against functions with jumps."""
_NO_STEP, _NO_PROGRESS, _START = 4e-16, 2e-16, 1e-9
"""Steps over the time reached that are too small to try, and to count as progress: they are lost in the rounding of the
time. Near time 0 that of 1 ns counts, below which nothing here happens."""
_GAUSS_X, _GAUSS_W = (v / 2 for v in np.polynomial.legendre.leggauss(5))
"""Five points are exact up to degree 9: the dense output is of degree 7, and forces are nearly so."""


class Control(NamedTuple):
    """Accuracy and bounds of an integration: local error at most ``tolerance * scale`` where scale > 0; times in s."""

    tolerance: float
    scale: np.ndarray
    first_step: float
    largest_step: float
    end: float


class TakenStep(NamedTuple):
    """A step with its dense output, in which switches are looked for, and the modes and memory during it."""

    t: float
    h: float
    dense: np.ndarray
    mode: np.ndarray
    memory: np.ndarray


class StepRecord(NamedTuple):
    """Accepted steps with their dense output, and the switches; one row a step or a switch."""

    time: np.ndarray
    step: np.ndarray
    dense: np.ndarray
    mode: np.ndarray
    memory: np.ndarray
    event_time: np.ndarray
    event: np.ndarray


def derivatives(system, t, y, mode, memory, dy):
    """Fill dy with the time derivative of the state (taught to each system's type)."""
    raise TypeError("compiled only")


def forces(system, t, y, mode, memory, out):
    """Fill out with the force of each link, N (taught to each system's type)."""
    raise TypeError("compiled only")


def switches(system, t, y, mode, memory, g):
    """Fill g with functions that are positive while the mode holds (taught to each system's type)."""
    raise TypeError("compiled only")


def horizon(system, t, y, mode, memory):
    """Return the largest step worth trying, s (taught to each system's type)."""
    raise TypeError("compiled only")


def switch(system, k, t, y, mode, memory):
    """Change the mode at switch k (taught to each system's type)."""
    raise TypeError("compiled only")


def empty_record(rows, states, modes, memories):
    """Return an unfilled record for so many steps."""
    return StepRecord(
        np.empty(rows),
        np.empty(rows),
        np.empty((rows, 8, states)),
        np.empty((rows, modes), dtype=np.int64),
        np.empty((rows, memories)),
        np.empty(rows),
        np.empty((rows, 2), dtype=np.int64),
    )


@leaf_kernel
def evaluate(dense, x, out):
    """Fill out with the dense output of one step at the fraction x of the step."""
    for i in range(out.size):
        value = dense[7, i] * x
        value = (value + dense[6, i]) * (1.0 - x)
        value = (value + dense[5, i]) * x
        value = (value + dense[4, i]) * (1.0 - x)
        value = (value + dense[3, i]) * x
        value = (value + dense[2, i]) * (1.0 - x)
        value = (value + dense[1, i]) * x
        out[i] = value + dense[0, i]


@leaf_kernel
def _weigh(weights, count, k, out):
    """Fill out with the weighted sum of the first stages; the inner loop is the longer one."""
    if out.size <= _FEW_STATES:
        for i in range(out.size):
            total = 0.0
            for j in range(count):
                total += weights[j] * k[j, i]
            out[i] = total
        return
    for i in range(out.size):
        out[i] = 0.0
    for j in range(count):
        w = weights[j]
        if w != 0.0:  # many weights are zero
            for i in range(out.size):
                out[i] += w * k[j, i]


@leaf_kernel
def _stage(system, s, t, h, y, mode, memory, work, k):
    _weigh(A[s], s, k, work)
    for i in range(y.size):
        work[i] = y[i] + h * work[i]
    derivatives(system, t + C[s] * h, work, mode, memory, k[s])


@inner_kernel
def _take_step(system, control, t, h, y, mode, memory, work, k, new):
    """Take one step into ``new`` and return its error over the tolerance."""
    for s in range(1, STAGES):
        _stage(system, s, t, h, y, mode, memory, work, k)
    _weigh(B, STAGES, k, new)
    for i in range(y.size):
        new[i] = y[i] + h * new[i]
    derivatives(system, t + h, new, mode, memory, k[STAGES])
    fifth, third, count = 0.0, 0.0, 0
    for i in range(y.size):
        if control.scale[i] <= 0.0:  # a state without a scale, such as an energy, follows the others
            continue
        e5, e3 = 0.0, 0.0
        for j in range(STAGES + 1):
            e5 += E5[j] * k[j, i]
            e3 += E3[j] * k[j, i]
        allowed = control.tolerance * control.scale[i]
        fifth += (e5 / allowed) ** 2
        third += (e3 / allowed) ** 2
        count += 1
    if fifth == 0.0 and third == 0.0:
        return 0.0
    # as in DOP853: the error of order 5 times its ratio to that of order 3 makes one of order 8
    return abs(h) * fifth / math.sqrt((fifth + 0.01 * third) * count)


@inner_kernel
def _fill_dense(system, t, h, y, new, mode, memory, work, k, dense):
    # counted by the arrays: loops of known length would be unrolled, which is four times the code
    for s in range(STAGES + 1, k.shape[0]):
        _stage(system, s, t, h, y, mode, memory, work, k)
    for i in range(y.size):
        delta = new[i] - y[i]
        dense[0, i] = y[i]
        dense[1, i] = delta
        dense[2, i] = h * k[0, i] - delta
        dense[3, i] = 2.0 * delta - h * (k[STAGES, i] + k[0, i])
    for r in range(dense.shape[0] - 4):
        _weigh(D[r], k.shape[0], k, dense[4 + r])
        for i in range(y.size):
            dense[4 + r, i] *= h


@leaf_kernel
def _switches_at(system, step, x, work, g):
    """Fill g with the switch functions at the fraction x of a step."""
    evaluate(step.dense, x, work)
    switches(system, step.t + x * step.h, work, step.mode, step.memory, g)


@inner_kernel
def _root(system, step, which, low, high, work, g):
    """Return the fraction of the step at which switch ``which`` falls through zero (Illinois rule)."""
    _switches_at(system, step, low, work, g)
    g_low = g[which]
    if g_low <= 0.0:  # it has fallen by the rounding of the switch before
        return low
    _switches_at(system, step, high, work, g)
    g_high = g[which]
    side = 0
    for _ in range(_ROOT_STEPS):
        x = (low * g_high - high * g_low) / (g_high - g_low)
        if not low < x < high:
            x = 0.5 * (low + high)
        if high - low < _ROOT_ROUNDING or x in (low, high):
            break
        _switches_at(system, step, x, work, g)
        value = g[which]
        if value > 0.0:
            low, g_low = x, value
            if side == 1:  # an end that stays for two steps is halved, or the secants creep towards it
                g_high *= 0.5
            side = 1
        else:
            high, g_high = x, value
            if side == -1:
                g_low *= 0.5
            side = -1
    return high  # the end behind the switch, so that the step ends with it


@inner_kernel
def _dip(system, step, j, earlier, previous, now, work, g):
    """Return a switch that falls below zero and rises again between three positive samples, and its place.

    The lowest point of the parabola through the samples decides where to look.
    """
    for which in range(now.size):
        a, b, c = earlier[which], previous[which], now[which]
        curvature = a - 2.0 * b + c
        if min(a, b, c) <= 0.0 or curvature <= 0.0:
            continue
        shift = 0.5 * (a - c) / curvature
        if abs(shift) >= 1.0 or b - 0.25 * (a - c) * shift > _DEEP_DIP * min(a, b, c):
            continue
        x = (j - 1 + shift) / _SAMPLES
        _switches_at(system, step, x, work, g)
        if g[which] < 0.0:
            low = (j - 2) / _SAMPLES if shift < 0.0 else (j - 1) / _SAMPLES
            return which, _root(system, step, which, low, x, work, g)
    return -1, 1.0


@inner_kernel
def _first_switch(system, step, before, rows, work, g):
    """Return the first switch within the step and its fraction; -1 when there is none. ``rows`` is scratch."""
    first, at = -1, 1.0
    size = before.size
    earlier, previous, now = rows[0], rows[1], rows[2]
    for which in range(size):
        earlier[which] = previous[which] = before[which]
    for j in range(1, _SAMPLES + 1):
        x = j / _SAMPLES
        _switches_at(system, step, x, work, now)
        for which in range(now.size):
            # at j = 1 also one that is negative at the begin already: the rounding of a switch just made
            if now[which] < 0.0 and (previous[which] >= 0.0 or j == 1):
                root = _root(system, step, which, (j - 1) / _SAMPLES, x, work, g)
                if first < 0 or root < at:
                    first, at = which, root
        if first < 0 and j > 1:
            first, at = _dip(system, step, j, earlier, previous, now, work, g)
        if first >= 0:
            return first, at
        for which in range(size):
            earlier[which], previous[which] = previous[which], now[which]
    return first, at


@kernel
def advance(system, control, t, h, y, mode, memory, record, count):
    """Integrate to ``control.end``, to a stopping switch, or until the record is full.

    ``y``, ``mode`` and ``memory`` are moved on in place. ``count`` is the number of switch functions.
    Returns why it came back (END, STOPPED, FULL, STUCK), the time, the next step to try, and how many
    steps and switches were recorded.
    """
    n = y.size
    work, new = np.empty(n), np.empty(n)
    k = np.zeros((_EXTENDED, n))
    before, g, rows = np.empty(count), np.empty(count), np.empty((3, count))
    steps, events, idle = 0, 0, 0
    derivatives(system, t, y, mode, memory, k[0])
    while t < control.end:
        if steps == record.time.size or events == record.event_time.size:
            return FULL, t, h, steps, events
        h = min(h, control.largest_step, control.end - t, horizon(system, t, y, mode, memory))
        switches(system, t, y, mode, memory, before)
        error = 0.0
        while True:
            error = _take_step(system, control, t, h, y, mode, memory, work, k, new)
            if error <= 1.0:
                break
            # an infinite error has no power to aim by
            h *= max(_SMALLEST, _SAFETY * error ** (-1.0 / _ORDER)) if error < math.inf else _SMALLEST
            if not h > _NO_STEP * max(abs(t), _START):
                return STUCK, t, h, steps, events
        dense = record.dense[steps]
        _fill_dense(system, t, h, y, new, mode, memory, work, k, dense)
        # looked for on the dense output of the whole step; a step up to the switch is then taken anew, under one mode
        which, fraction = _first_switch(system, TakenStep(t, h, dense, mode, memory), before, rows, work, g)
        growth = _LARGEST if error == 0.0 else min(_LARGEST, _SAFETY * error ** (-1.0 / _ORDER))
        taken = h
        if which >= 0:
            taken = fraction * h
            if taken > _NO_PROGRESS * max(abs(t), _START):  # below, time would stand still: the switch acts at once
                _take_step(system, control, t, taken, y, mode, memory, work, k, new)
                _fill_dense(system, t, taken, y, new, mode, memory, work, k, dense)
                idle = 0
            else:
                taken = 0.0
                idle += 1
                if idle > _IDLE_LIMIT:
                    return STUCK, t, h, steps, events
        if taken > 0.0:
            record.time[steps] = t
            record.step[steps] = taken
            for i in range(mode.size):
                record.mode[steps, i] = mode[i]
            for i in range(memory.size):
                record.memory[steps, i] = memory[i]
            steps += 1
            t += taken
            for i in range(n):
                y[i] = new[i]
                k[0, i] = k[STAGES, i]  # the derivative at the end of a step is that at the begin of the next
        if which < 0:
            idle = 0
            h *= max(_SMALLEST, growth)
            continue
        record.event_time[events] = t
        record.event[events, 0] = which
        record.event[events, 1] = steps
        events += 1
        code = switch(system, which, t, y, mode, memory)
        derivatives(system, t, y, mode, memory, k[0])  # those before the switch are of another mode
        if code == STOP:
            return STOPPED, t, h, steps, events
        if code == RESTART:
            h = min(h, control.first_step)
    return END, t, h, steps, events


@called_kernel
def sample(system, record, times, states, out):
    """Fill ``states`` (N, n) and ``out`` (N, links) with the motion and link forces at sorted times."""
    row = 0
    last = record.time.size - 1
    for i in range(times.size):
        while row < last and times[i] >= record.time[row + 1]:
            row += 1
        # times at the ends of a step may lie outside by rounding
        x = min(max((times[i] - record.time[row]) / record.step[row], 0.0), 1.0)
        evaluate(record.dense[row], x, states[i])
        forces(system, record.time[row] + x * record.step[row], states[i], record.mode[row], record.memory[row], out[i])


@kernel
def impulses(system, record, out):
    """Fill ``out`` (steps, links) with the time integral of each link force over each step (5-point Gauss)."""
    state = np.empty(record.dense.shape[2])
    force = np.empty(out.shape[1])
    for row in range(record.time.size):
        for link in range(out.shape[1]):
            out[row, link] = 0.0
        for x, w in zip(_GAUSS_X, _GAUSS_W):  # noqa: B905  (numba's zip knows no strict)
            evaluate(record.dense[row], 0.5 + x, state)
            t = record.time[row] + (0.5 + x) * record.step[row]
            forces(system, t, state, record.mode[row], record.memory[row], force)
            for link in range(out.shape[1]):
                out[row, link] += w * record.step[row] * force[link]
