"""Compiled passes of a fast run: the table of its blows, written while the steps come."""

from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import inner_kernel, leaf_kernel
from strikewave.contact._chain_kernels import GRAVITY, MASS, OPEN, PUSHING, link_push, press
from strikewave.contact._integrator import evaluate
from strikewave.machines._kernels import HELD, NOSE_SHARE, PITCH, RELEASED, RETRACTING, place_bases
from strikewave.machines._layout import OBJECT, layout_of
from strikewave.signal.pulse import FOOT, WIDTH_FRACTION

(
    PASS,
    STRIKER,
    TIME,
    APPROACH,
    PEAK,
    WIDTH,
    VELOCITY_CHANGE,
    CONTACTS,
    IMPULSE,
    LATER,
    FACE,
    FACE_SPEED,
    LARGEST_DISPLACEMENT,
    STOP_FORCE,
    ANGLE,
    DISC_SPEED,
    BLOW_CHANGE,
    LAST_CHANGE,
    BLOW_IMPULSE,
) = range(19)
"""Columns of the table of blows: pass number, striker (from 0), time of first touch (of the apex where missed, then
with CONTACTS 0), approach speed, rigid peak, its width at 10 %, velocity change from foot to foot of that pulse,
contacts, impulse of the contacts and of the second and later groups of them, place and speed of the face at first touch
(place at the apex where missed), largest displacement (NaN where missed), largest force of the stop until the next
pass, turntable's angle at first touch less that of the strike position, and its speed; velocity change of the object to
the release before the first gap longer than the width, and to the last release; contact impulse of the blow."""
BLOW_COLUMNS = 19

CURRENT, SAMPLES, CONTACTS_SEEN, ROWS_USED, IN_TOUCH, FALLEN, FLIGHT_STEPS, BLOW_STEPS, COUNTS = range(9)
"""Places of `PassTable.counts`: row of the blow that lasts (-1 where none), samples and contacts of it, rows, in touch,
whether the pulse has fallen, steps taken between blows and in blows."""
LET_GO, FIRST_PLACE, HIGHEST, SPEED_BEFORE, TOP, NUMBERS = range(6)
"""Places of `PassTable.numbers`: energy let go, J; of the blow that lasts: place of the assembly at first touch and
highest since, m, speed of the object at first touch, m/s, largest rigid acceleration sampled, m/s^2."""
LEVEL, FOOT_LEVEL = WIDTH_FRACTION, FOOT
"""Shares of the peak at which the width is taken, and at which the pulse ends whose velocity change is taken."""
_NODES, _WEIGHTS = (0.5 * v for v in np.polynomial.legendre.leggauss(5))
"""Gauss points of a step, as the integrator's impulses have them: the dense output is of degree 7."""
_STOP_SAMPLES = 8
"""Samples of the force of the stop in a step of free flight (chosen: a step covers a part of its half-sine)."""
_HALVINGS = 30
"""Halvings of a step for the turning place: 1e-9 of the step, and a square of that in the place."""


class PassTable(NamedTuple):
    """Record of a pass: the table of blows, and samples and contacts of the blow that lasts.

    Samples are time, rigid acceleration and speed of the assembly; contacts are begin, end, impulse, and velocity
    change of the object to their end.
    """

    table: np.ndarray
    samples: np.ndarray
    contacts: np.ndarray
    counts: np.ndarray
    numbers: np.ndarray


@inner_kernel
def open_row(flight, blow, going, struck, passes, t):
    """Begin the row of a pass at its first touch; a later touch of the same pass adds a contact to its row.

    Returns False where no row is left.
    """
    counts, numbers, at, y = passes.counts, passes.numbers, layout_of(blow), struck.y
    number = round(y[at.angle] / flight.settings[PITCH])  # the nearest: a touch comes before or after the apex
    other = counts[CURRENT] < 0 or passes.table[counts[CURRENT], PASS] != number
    if other and not _next_row(passes):
        return False
    if other or passes.table[counts[CURRENT], CONTACTS] == 0.0:
        counts[SAMPLES] = counts[CONTACTS_SEEN] = counts[FALLEN] = 0
        numbers[TOP] = -np.inf
        row = passes.table[counts[CURRENT]]
        row[PASS], row[STRIKER], row[TIME] = number, going.mode[layout_of(flight).touching], t
        row[APPROACH], row[PEAK], row[WIDTH] = struck.memory[at.contacts.start], np.nan, np.nan
        row[CONTACTS] = row[IMPULSE] = row[LATER] = row[VELOCITY_CHANGE] = 0.0
        row[BLOW_CHANGE] = row[LAST_CHANGE] = row[BLOW_IMPULSE] = 0.0
        row[FACE], row[FACE_SPEED] = y[at.positions][at.nose], y[at.speeds][at.nose]
        row[DISC_SPEED] = y[at.turntable_speed]
        row[ANGLE] = y[at.angle] - number * flight.settings[PITCH]
        numbers[FIRST_PLACE] = numbers[HIGHEST] = y[at.positions][at.assembly]
        numbers[SPEED_BEFORE] = y[at.speeds][at.nose]
    _open_contact(passes, t)
    return True


@leaf_kernel
def _next_row(passes):
    """Begin another row; False where none is left."""
    counts = passes.counts
    if counts[ROWS_USED] == passes.table.shape[0]:
        return False
    counts[CURRENT] = counts[ROWS_USED]
    counts[ROWS_USED] += 1
    passes.table[counts[CURRENT], STOP_FORCE] = 0.0
    return True


@leaf_kernel
def _open_contact(passes, t):
    counts = passes.counts
    passes.table[counts[CURRENT], CONTACTS] += 1.0
    counts[IN_TOUCH] = 1
    if counts[CONTACTS_SEEN] < passes.contacts.shape[0]:
        passes.contacts[counts[CONTACTS_SEEN], 0] = passes.contacts[counts[CONTACTS_SEEN], 1] = t
        passes.contacts[counts[CONTACTS_SEEN], 2] = passes.contacts[counts[CONTACTS_SEEN], 3] = 0.0
        counts[CONTACTS_SEEN] += 1


@inner_kernel
def missed_row(flight, going, passes, t, face):
    """Write down the pass whose apex has just come, if the object was held in place and nothing touched it.

    Returns False where no row is left.
    """
    at, counts = layout_of(flight), passes.counts
    phase = going.mode[at.feed]
    held = phase == HELD or (phase == RELEASED and going.memory[at.feed_start] == t)  # released by this very apex
    number = round(going.y[at.angle] / flight.settings[PITCH])
    last = passes.table[counts[ROWS_USED] - 1, PASS] if counts[ROWS_USED] > 0 else -1.0
    if not held or number <= last:
        return True
    if not _next_row(passes):
        return False
    row = passes.table[counts[CURRENT]]
    row[PASS], row[STRIKER], row[TIME], row[FACE] = number, number % flight.seats.shape[0], t, face
    row[CONTACTS] = row[VELOCITY_CHANGE] = row[BLOW_CHANGE] = row[LAST_CHANGE] = row[BLOW_IMPULSE] = 0.0
    row[DISC_SPEED] = going.y[at.turntable_speed]
    return True


@inner_kernel
def note_blow(flight, blow, struck, passes, steps, work):
    """Write down what the last steps of a blow show: rigid acceleration, impulse of the contact, its end, the stop."""
    record, counts, numbers = struck.record, passes.counts, passes.numbers
    row, at = passes.table[counts[CURRENT]], layout_of(blow)
    contact, speeds, share = at.contacts.start, work[at.speeds], flight.settings[NOSE_SHARE]
    counts[BLOW_STEPS] += steps
    for r in range(steps):
        closed = record.mode[r, contact] != OPEN
        if closed and counts[IN_TOUCH] == 0:
            _open_contact(passes, record.time[r])
        _note_support(blow, record, r, passes, work)
        for k in range(_NODES.size):
            if counts[FALLEN] == 0 or closed:  # impulses count as long as it touches
                _sample_blow(blow, record, r, 0.5 + _NODES[k], closed * _WEIGHTS[k], passes, work)
        after = record.mode[r + 1, contact] if r + 1 < steps else struck.mode[contact]
        if closed and after == OPEN:
            counts[IN_TOUCH] = 0
            evaluate(record.dense[r], 1.0, work)
            row[LAST_CHANGE] = share * speeds[at.nose] + (1.0 - share) * speeds[at.assembly] - numbers[SPEED_BEFORE]
            passes.contacts[counts[CONTACTS_SEEN] - 1, 1] = record.time[r] + record.step[r]
            passes.contacts[counts[CONTACTS_SEEN] - 1, 3] = row[LAST_CHANGE]


@inner_kernel
def _note_support(blow, record, r, passes, work):
    """Write down displacement and force of the stop at begin, middle and end of a step of a blow."""
    numbers, row, at = passes.numbers, passes.table[passes.counts[CURRENT]], layout_of(blow)
    mode, memory = record.mode[r], record.memory[r]
    for k in range(3):
        evaluate(record.dense[r], 0.5 * k, work)
        numbers[HIGHEST] = max(numbers[HIGHEST], work[at.positions][at.assembly])
        if mode[at.stop] == PUSHING:
            place_bases(blow, record.time[r] + 0.5 * k * record.step[r], work, mode, memory)
            force, _, _ = press(blow.chain, at.stop, work, mode, memory)
            row[STOP_FORCE] = max(row[STOP_FORCE], force)
    row[LARGEST_DISPLACEMENT] = numbers[HIGHEST] - numbers[FIRST_PLACE]


@inner_kernel
def _sample_blow(blow, record, r, x, weight, passes, work):
    """Write down one sample of a step of a blow, at the fraction x of the step."""
    counts, numbers, at, chain = passes.counts, passes.numbers, layout_of(blow), blow.chain
    row, mode, memory = passes.table[counts[CURRENT]], record.mode[r], record.memory[r]
    t = record.time[r] + x * record.step[r]
    evaluate(record.dense[r], x, work)
    place_bases(blow, t, work, mode, memory)
    pushed = 0.0
    for j in range(at.frame, chain.joins.shape[0]):
        force, _, _ = link_push(chain, j, work, mode, memory)
        # the assembly is ahead on these links, behind on the others
        pushed += force if j in (at.frame, at.stop) else -force
    if counts[SAMPLES] < passes.samples.shape[1]:
        passes.samples[0, counts[SAMPLES]] = t
        a = pushed / chain.bodies[at.assembly, MASS] + chain.bodies[at.assembly, GRAVITY]
        passes.samples[1, counts[SAMPLES]] = a
        passes.samples[2, counts[SAMPLES]] = work[at.speeds][at.assembly]
        counts[SAMPLES] += 1
        numbers[TOP] = max(numbers[TOP], a)
        # apart and fallen to its foot: the rest is no part of the pulse
        counts[FALLEN] = 1 if weight == 0.0 and a < FOOT_LEVEL * numbers[TOP] else 0
    if weight > 0.0:
        force, _, _ = press(chain, at.contacts.start, work, mode, memory)
        row[IMPULSE] += weight * record.step[r] * force
        passes.contacts[counts[CONTACTS_SEEN] - 1, 2] += weight * record.step[r] * force


@inner_kernel
def measure_row(passes):
    """Find peak and width of the rigid acceleration of the blow that lasts, and what its later contacts add."""
    count, row = passes.counts[SAMPLES], passes.table[passes.counts[CURRENT]]
    time, a = passes.samples[0], passes.samples[1]
    top = 0
    for k in range(count):
        if a[k] > a[top]:
            top = k
    row[PEAK] = a[top]
    if 0 < top < count - 1:
        before, after = time[top - 1] - time[top], time[top + 1] - time[top]
        left, right = (a[top - 1] - a[top]) / before, (a[top + 1] - a[top]) / after
        # of the parabola through three samples, which are not evenly spaced
        curvature = (right - left) / (after - before)
        slope = left - curvature * before
        if curvature < 0.0:
            row[PEAK] = a[top] - 0.25 * slope * slope / curvature
    begin, end, _, _ = _crossings(passes.samples, top, count, LEVEL * row[PEAK])
    row[WIDTH], row[LATER] = end - begin, 0.0
    begin, end, before, after = _crossings(passes.samples, top, count, FOOT_LEVEL * row[PEAK])
    row[VELOCITY_CHANGE] = after - before
    later = False
    for k in range(passes.counts[CONTACTS_SEEN]):
        later = later or (k > 0 and passes.contacts[k, 0] - passes.contacts[k - 1, 1] > row[WIDTH])
        if later:
            row[LATER] += passes.contacts[k, 2]
        else:
            row[BLOW_CHANGE] = passes.contacts[k, 3]
    row[BLOW_IMPULSE] = row[IMPULSE] - row[LATER]


@leaf_kernel
def _crossings(samples, top, count, level):
    """Return when the samples rise through a level before their top and fall through it after, and both speeds.

    Where they do not, the times are NaN and the speeds those of the first and the last sample.
    """
    time, a, speed = samples[0], samples[1], samples[2]
    begin, end, before, after = np.nan, np.nan, speed[0], speed[count - 1]
    for k in range(top, 0, -1):
        if a[k - 1] <= level:
            part = (level - a[k]) / (a[k - 1] - a[k])
            begin, before = time[k] + part * (time[k - 1] - time[k]), speed[k] + part * (speed[k - 1] - speed[k])
            break
    for k in range(top, count - 1):
        if a[k + 1] <= level:
            part = (level - a[k]) / (a[k + 1] - a[k])
            end, after = time[k] + part * (time[k + 1] - time[k]), speed[k] + part * (speed[k + 1] - speed[k])
            break
    return begin, end, before, after


@inner_kernel
def note_flight(flight, going, passes, steps, work):
    """Write down displacement and force of the stop of the steps after a pass, until the next touch or retraction."""
    record, counts, numbers = going.record, passes.counts, passes.numbers
    at = layout_of(flight)
    place, speed, speed_before = work[at.positions], work[at.speeds], record.dense[:, 0, at.speeds]
    counts[FLIGHT_STEPS] += steps
    if counts[CURRENT] < 0:
        return
    row = passes.table[counts[CURRENT]]
    for r in range(steps):
        mode, memory, dense = record.mode[r], record.memory[r], record.dense[r]
        if mode[at.feed] == RETRACTING:  # the carriage then takes the object along
            break
        evaluate(dense, 1.0, work)
        numbers[HIGHEST] = max(numbers[HIGHEST], place[OBJECT])
        if speed_before[r, OBJECT] > 0.0 > speed[OBJECT]:
            numbers[HIGHEST] = max(numbers[HIGHEST], _turning_place(at, dense, work))
        for k in range(_STOP_SAMPLES + 1):
            if mode[at.stop] != PUSHING:
                break
            evaluate(dense, k / _STOP_SAMPLES, work)
            t = record.time[r] + k / _STOP_SAMPLES * record.step[r]
            place_bases(flight, t, work, mode, memory)
            force, _, _ = press(flight.chain, at.stop, work, mode, memory)
            row[STOP_FORCE] = max(row[STOP_FORCE], force)
    if row[CONTACTS] > 0.0:
        row[LARGEST_DISPLACEMENT] = numbers[HIGHEST] - numbers[FIRST_PLACE]


@leaf_kernel
def _turning_place(at, dense, work):
    """Return the place at which the object turns back within a step: its speed falls through zero there."""
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        x = 0.5 * (low + high)
        evaluate(dense, x, work)
        if work[at.speeds][OBJECT] > 0.0:
            low = x
        else:
            high = x
    return work[at.positions][OBJECT]


@inner_kernel
def repeats(table, rows, tolerance, strikers):
    """Return whether the last blows repeat with a period up to 4, or a whole turn, within a tolerance.

    Eight blows and four periods are compared in approach speed and angle of first touch, relative to the last.
    """
    for k in range(1, 6):
        period = k if k < 5 else strikers
        length = max(8, 4 * period)  # chosen: chance repeats two or three blows, not four periods
        if rows < length + period:
            continue
        same = True
        for j in range(rows - length, rows):
            for column in (APPROACH, ANGLE):
                near = abs(table[j, column] - table[j - period, column]) <= tolerance * abs(table[rows - 1, column])
                same = same and near
        if same:
            return True
    return False
