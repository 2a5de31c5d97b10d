"""Compiled notes of a fast run: the table of its blows, written while the steps come."""

from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import called_kernel, leaf_kernel
from strikewave.contact._chain_kernels import (
    CONTACT,
    FRICTION,
    GRAVITY,
    KIND,
    MASS,
    OPEN,
    PUSHING,
    STOP_LINK,
    friction_force,
    link_force,
    link_motion,
    spot_of,
)
from strikewave.contact._integrator import evaluate
from strikewave.machines._kernels import FEED, FEED_START, HELD, ON_FACE, PITCH, RELEASED, RETRACTING, place_bases

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
    RETREAT,
    STOP_FORCE,
    ANGLE,
    DISC_SPEED,
    LAST_CHANGE,
) = range(17)
"""Columns of the table of blows: pass number, striker (from 0), time of first touch (of the apex where missed, then
with CONTACTS 0), approach speed, rigid peak, its width at 10 %, velocity change to the release before the first gap
longer than that, contacts, impulse of the contacts and of the second and later groups of them, place and speed of the
face at first touch (place at the apex where missed), largest retreat (NaN where missed), largest force of the stop
until the next pass, turntable's angle at first touch less that of the strike position, and its speed; velocity change
to the last release."""
BLOW_COLUMNS = 17

CURRENT, SAMPLES, CONTACTS_SEEN, ROWS_USED, IN_TOUCH, FALLEN, COAST_STEPS, BLOW_STEPS, COUNTS = range(9)
"""Places of `Notes.counts`: row of the blow that lasts (-1 where none), samples and contacts of it, rows, in touch,
whether the pulse has fallen, steps taken between blows and in blows."""
LET_GO, FIRST_PLACE, HIGHEST, SPEED_BEFORE, TOP, NUMBERS = range(6)
"""Places of `Notes.numbers`: energy let go, J; of the blow that lasts: place of the assembly at first touch and highest
since, m, speed of the object at first touch, m/s, largest rigid acceleration sampled, m/s^2."""
LEVEL = 0.1
"""Share of the peak at which the width is taken."""
_NODES, _WEIGHTS = (0.5 * v for v in np.polynomial.legendre.leggauss(5))
_STOP_SAMPLES = 8
_STOP = 4
"""Which join of a blow is the stop."""


class Notes(NamedTuple):
    """What is written down: the table of blows, and of the one that lasts its samples and contacts.

    Samples are time and rigid acceleration; contacts are begin, end, impulse, and velocity change to their end.
    """

    table: np.ndarray
    samples: np.ndarray
    contacts: np.ndarray
    counts: np.ndarray
    numbers: np.ndarray


@called_kernel
def open_row(coast, blow, going, struck, notes, t):
    """Begin the row of a pass at its first touch; a later touch of the same pass adds a contact to its row.

    Returns False where no row is left.
    """
    counts, numbers = notes.counts, notes.numbers
    links, noses = coast.joins.shape[0], coast.noses.shape[0]
    number = round(struck.y[6] / coast.settings[PITCH])
    other = counts[CURRENT] < 0 or notes.table[counts[CURRENT], PASS] != number
    if other and not _next_row(notes):
        return False
    if other or notes.table[counts[CURRENT], CONTACTS] == 0.0:
        counts[SAMPLES] = counts[CONTACTS_SEEN] = counts[FALLEN] = 0
        numbers[TOP] = -np.inf
        row = notes.table[counts[CURRENT]]
        row[PASS], row[STRIKER], row[TIME] = number, going.mode[links + ON_FACE + noses], t
        row[APPROACH], row[PEAK], row[WIDTH] = struck.memory[0], np.nan, np.nan
        row[CONTACTS] = row[IMPULSE] = row[LATER] = row[VELOCITY_CHANGE] = row[LAST_CHANGE] = 0.0
        row[FACE], row[FACE_SPEED], row[DISC_SPEED] = struck.y[1], struck.y[4], struck.y[7]
        row[ANGLE] = struck.y[6] - number * coast.settings[PITCH]
        numbers[FIRST_PLACE] = numbers[HIGHEST] = struck.y[2]
        numbers[SPEED_BEFORE] = struck.y[4]
    _open_contact(notes, t)
    return True


@leaf_kernel
def _next_row(notes):
    """Begin another row; False where none is left."""
    counts = notes.counts
    if counts[ROWS_USED] == notes.table.shape[0]:
        return False
    counts[CURRENT] = counts[ROWS_USED]
    counts[ROWS_USED] += 1
    notes.table[counts[CURRENT], STOP_FORCE] = 0.0
    return True


@leaf_kernel
def _open_contact(notes, t):
    counts = notes.counts
    notes.table[counts[CURRENT], CONTACTS] += 1.0
    counts[IN_TOUCH] = 1
    if counts[CONTACTS_SEEN] < notes.contacts.shape[0]:
        notes.contacts[counts[CONTACTS_SEEN], 0] = notes.contacts[counts[CONTACTS_SEEN], 1] = t
        notes.contacts[counts[CONTACTS_SEEN], 2] = notes.contacts[counts[CONTACTS_SEEN], 3] = 0.0
        counts[CONTACTS_SEEN] += 1


@called_kernel
def missed_row(coast, going, notes, t, face):
    """Write down the pass whose apex has just come, if the object was held in place and nothing touched it.

    Returns False where no row is left.
    """
    links, counts = coast.joins.shape[0], notes.counts
    phase = going.mode[links + FEED]
    held = phase == HELD or (phase == RELEASED and going.memory[links + FEED_START] == t)
    number = round(going.y[2] / coast.settings[PITCH])
    last = notes.table[counts[ROWS_USED] - 1, PASS] if counts[ROWS_USED] > 0 else -1.0
    if not held or number <= last:
        return True
    if not _next_row(notes):
        return False
    row = notes.table[counts[CURRENT]]
    row[PASS], row[STRIKER], row[TIME], row[FACE] = number, number % coast.noses.shape[0], t, face
    row[CONTACTS] = row[VELOCITY_CHANGE] = row[LAST_CHANGE] = 0.0
    row[DISC_SPEED] = going.y[3]
    return True


@called_kernel
def note_blow(coast, blow, struck, notes, steps, work):
    """Write down what the last steps of a blow show: rigid acceleration, impulse of the contact, its end, the stop."""
    record, counts, numbers = struck.record, notes.counts, notes.numbers
    row = notes.table[counts[CURRENT]]
    counts[BLOW_STEPS] += steps
    share = coast.frame[3]
    for r in range(steps):
        closed = record.mode[r, 0] != OPEN
        if closed and counts[IN_TOUCH] == 0:
            _open_contact(notes, record.time[r])
        _note_support(blow, record, r, notes, work)
        for k in range(_NODES.size):
            if counts[FALLEN] == 0 or closed:
                _sample_blow(coast, blow, record, r, 0.5 + _NODES[k], closed * _WEIGHTS[k], notes, work)
        after = record.mode[r + 1, 0] if r + 1 < steps else struck.mode[0]
        if closed and after == OPEN:
            counts[IN_TOUCH] = 0
            evaluate(record.dense[r], 1.0, work)
            row[LAST_CHANGE] = share * work[4] + (1.0 - share) * work[5] - numbers[SPEED_BEFORE]
            notes.contacts[counts[CONTACTS_SEEN] - 1, 1] = record.time[r] + record.step[r]
            notes.contacts[counts[CONTACTS_SEEN] - 1, 3] = row[LAST_CHANGE]


@called_kernel
def _note_support(blow, record, r, notes, work):
    """Write down retreat and force of the stop at begin, middle and end of a step of a blow."""
    numbers, row = notes.numbers, notes.table[notes.counts[CURRENT]]
    for k in range(3):
        evaluate(record.dense[r], 0.5 * k, work)
        numbers[HIGHEST] = max(numbers[HIGHEST], work[2])
        if record.mode[r, _STOP] == PUSHING:
            place_bases(blow, record.time[r] + 0.5 * k * record.step[r], work, record.mode[r], record.memory[r])
            d, rate = link_motion(blow.joins, blow.values, _STOP, work, blow.bases, 3)
            force, _ = link_force(STOP_LINK, blow.values[_STOP], d, rate, PUSHING, 0.0, 0.0, 1.0)
            row[STOP_FORCE] = max(row[STOP_FORCE], force)
    row[RETREAT] = numbers[HIGHEST] - numbers[FIRST_PLACE]


@called_kernel
def _sample_blow(coast, blow, record, r, x, weight, notes, work):
    """Write down one sample of a step of a blow, at the fraction x of the step."""
    counts, numbers = notes.counts, notes.numbers
    row = notes.table[counts[CURRENT]]
    t = record.time[r] + x * record.step[r]
    evaluate(record.dense[r], x, work)
    place_bases(blow, t, work, record.mode[r], record.memory[r])
    pushed = 0.0
    for j in range(2, blow.joins.shape[0]):
        d, rate = link_motion(blow.joins, blow.values, j, work, blow.bases, 3)
        if blow.joins[j, KIND] == FRICTION:
            pushed -= friction_force(
                blow.joins, blow.values, blow.bodies, work, blow.bases, record.mode[r], record.memory[r], j
            )
            continue
        force, _ = link_force(blow.joins[j, KIND], blow.values[j], d, rate, record.mode[r, j], 0.0, 0.0, 1.0)
        pushed += -force if j == 3 else force
    if counts[SAMPLES] < notes.samples.shape[1]:
        notes.samples[0, counts[SAMPLES]] = t
        a = pushed / blow.bodies[2, MASS] + blow.bodies[2, GRAVITY]
        notes.samples[1, counts[SAMPLES]] = a
        counts[SAMPLES] += 1
        numbers[TOP] = max(numbers[TOP], a)
        counts[FALLEN] = 1 if weight == 0.0 and a < LEVEL * numbers[TOP] else 0
    if weight > 0.0:
        d, rate = link_motion(blow.joins, blow.values, 0, work, blow.bases, 3)
        deepest, s = spot_of(blow.joins, record.memory[r], 0)
        force, _ = link_force(CONTACT, blow.values[0], d, rate, record.mode[r, 0], record.memory[r, 0], deepest, s)
        row[IMPULSE] += weight * record.step[r] * force
        notes.contacts[counts[CONTACTS_SEEN] - 1, 2] += weight * record.step[r] * force


@called_kernel
def measure_row(notes):
    """Find peak and width of the rigid acceleration of the blow that lasts, and what its later contacts add."""
    count, row = notes.counts[SAMPLES], notes.table[notes.counts[CURRENT]]
    time, a = notes.samples[0], notes.samples[1]
    top = 0
    for k in range(count):
        if a[k] > a[top]:
            top = k
    row[PEAK] = a[top]
    if 0 < top < count - 1:
        before, after = time[top - 1] - time[top], time[top + 1] - time[top]
        left, right = (a[top - 1] - a[top]) / before, (a[top + 1] - a[top]) / after
        curvature = (right - left) / (after - before)
        slope = left - curvature * before
        if curvature < 0.0:
            row[PEAK] = a[top] - 0.25 * slope * slope / curvature
    level, begin, end = LEVEL * row[PEAK], np.nan, np.nan
    for k in range(top, 0, -1):
        if a[k - 1] <= level:
            begin = time[k] + (level - a[k]) * (time[k - 1] - time[k]) / (a[k - 1] - a[k])
            break
    for k in range(top, count - 1):
        if a[k + 1] <= level:
            end = time[k] + (level - a[k]) * (time[k + 1] - time[k]) / (a[k + 1] - a[k])
            break
    row[WIDTH], row[LATER] = end - begin, 0.0
    later = False
    for k in range(notes.counts[CONTACTS_SEEN]):
        later = later or (k > 0 and notes.contacts[k, 0] - notes.contacts[k - 1, 1] > row[WIDTH])
        if later:
            row[LATER] += notes.contacts[k, 2]
        else:
            row[VELOCITY_CHANGE] = notes.contacts[k, 3]


@called_kernel
def note_coast(coast, going, notes, steps, work):
    """Write down retreat and force of the stop of the steps after a pass, until the next touch or the retraction."""
    record, counts, numbers = going.record, notes.counts, notes.numbers
    links = coast.joins.shape[0]
    counts[COAST_STEPS] += steps
    if counts[CURRENT] < 0:
        return
    row = notes.table[counts[CURRENT]]
    for r in range(steps):
        if record.mode[r, links + FEED] == RETRACTING:
            break
        dense = record.dense[r]
        evaluate(dense, 1.0, work)
        numbers[HIGHEST] = max(numbers[HIGHEST], work[0])
        if dense[0, 1] > 0.0 > work[1]:
            numbers[HIGHEST] = max(numbers[HIGHEST], _turning_place(dense, work))
        for k in range(_STOP_SAMPLES + 1):
            if record.mode[r, 1] != PUSHING:
                break
            evaluate(dense, k / _STOP_SAMPLES, work)
            t = record.time[r] + k / _STOP_SAMPLES * record.step[r]
            place_bases(coast, t, work, record.mode[r], record.memory[r])
            d, rate = link_motion(coast.joins, coast.values, 1, work, coast.bases, 1)
            force, _ = link_force(STOP_LINK, coast.values[1], d, rate, PUSHING, 0.0, 0.0, 1.0)
            row[STOP_FORCE] = max(row[STOP_FORCE], force)
    if row[CONTACTS] > 0.0:
        row[RETREAT] = numbers[HIGHEST] - numbers[FIRST_PLACE]


@leaf_kernel
def _turning_place(dense, work):
    """Return the place at which the object turns back within a step: its speed falls through zero there."""
    low, high = 0.0, 1.0
    for _ in range(30):
        x = 0.5 * (low + high)
        evaluate(dense, x, work)
        if work[1] > 0.0:
            low = x
        else:
            high = x
    return work[0]


@called_kernel
def repeats(table, rows, tolerance, strikers):
    """Tell whether the last blows repeat with a period up to 4, or a whole turn, within a tolerance.

    Eight blows and four periods are compared in approach speed and angle of first touch, relative to the last.
    """
    for k in range(1, 6):
        period = k if k < 5 else strikers
        length = max(8, 4 * period)
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
