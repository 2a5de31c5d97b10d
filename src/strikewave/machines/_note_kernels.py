"""Compiled notes of a fast run: the table of its blows, written while the steps come."""

from typing import NamedTuple

import numpy as np

from strikewave.base.compiled import called_kernel, leaf_kernel
from strikewave.contact._chain_kernels import GRAVITY, MASS, OPEN, PUSHING, link_push, press
from strikewave.contact._integrator import evaluate
from strikewave.machines._kernels import HELD, PITCH, RELEASED, RETRACTING, place_bases
from strikewave.machines._layout import OBJECT, layout_of

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
    counts, numbers, at, y = notes.counts, notes.numbers, layout_of(blow), struck.y
    number = round(y[at.angle] / coast.settings[PITCH])
    other = counts[CURRENT] < 0 or notes.table[counts[CURRENT], PASS] != number
    if other and not _next_row(notes):
        return False
    if other or notes.table[counts[CURRENT], CONTACTS] == 0.0:
        counts[SAMPLES] = counts[CONTACTS_SEEN] = counts[FALLEN] = 0
        numbers[TOP] = -np.inf
        row = notes.table[counts[CURRENT]]
        row[PASS], row[STRIKER], row[TIME] = number, going.mode[layout_of(coast).touching], t
        row[APPROACH], row[PEAK], row[WIDTH] = struck.memory[at.contacts.start], np.nan, np.nan
        row[CONTACTS] = row[IMPULSE] = row[LATER] = row[VELOCITY_CHANGE] = row[LAST_CHANGE] = 0.0
        row[FACE], row[FACE_SPEED] = y[at.positions][at.nose], y[at.speeds][at.nose]
        row[DISC_SPEED] = y[at.turntable_speed]
        row[ANGLE] = y[at.angle] - number * coast.settings[PITCH]
        numbers[FIRST_PLACE] = numbers[HIGHEST] = y[at.positions][at.assembly]
        numbers[SPEED_BEFORE] = y[at.speeds][at.nose]
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
    at, counts = layout_of(coast), notes.counts
    phase = going.mode[at.feed]
    held = phase == HELD or (phase == RELEASED and going.memory[at.feed_start] == t)
    number = round(going.y[at.angle] / coast.settings[PITCH])
    last = notes.table[counts[ROWS_USED] - 1, PASS] if counts[ROWS_USED] > 0 else -1.0
    if not held or number <= last:
        return True
    if not _next_row(notes):
        return False
    row = notes.table[counts[CURRENT]]
    row[PASS], row[STRIKER], row[TIME], row[FACE] = number, number % coast.seats.shape[0], t, face
    row[CONTACTS] = row[VELOCITY_CHANGE] = row[LAST_CHANGE] = 0.0
    row[DISC_SPEED] = going.y[at.turntable_speed]
    return True


@called_kernel
def note_blow(coast, blow, struck, notes, steps, work):
    """Write down what the last steps of a blow show: rigid acceleration, impulse of the contact, its end, the stop."""
    record, counts, numbers = struck.record, notes.counts, notes.numbers
    row, at = notes.table[counts[CURRENT]], layout_of(blow)
    contact, speeds, share = at.contacts.start, work[at.speeds], coast.frame.share
    counts[BLOW_STEPS] += steps
    for r in range(steps):
        closed = record.mode[r, contact] != OPEN
        if closed and counts[IN_TOUCH] == 0:
            _open_contact(notes, record.time[r])
        _note_support(blow, record, r, notes, work)
        for k in range(_NODES.size):
            if counts[FALLEN] == 0 or closed:
                _sample_blow(blow, record, r, 0.5 + _NODES[k], closed * _WEIGHTS[k], notes, work)
        after = record.mode[r + 1, contact] if r + 1 < steps else struck.mode[contact]
        if closed and after == OPEN:
            counts[IN_TOUCH] = 0
            evaluate(record.dense[r], 1.0, work)
            row[LAST_CHANGE] = share * speeds[at.nose] + (1.0 - share) * speeds[at.assembly] - numbers[SPEED_BEFORE]
            notes.contacts[counts[CONTACTS_SEEN] - 1, 1] = record.time[r] + record.step[r]
            notes.contacts[counts[CONTACTS_SEEN] - 1, 3] = row[LAST_CHANGE]


@called_kernel
def _note_support(blow, record, r, notes, work):
    """Write down retreat and force of the stop at begin, middle and end of a step of a blow."""
    numbers, row, at = notes.numbers, notes.table[notes.counts[CURRENT]], layout_of(blow)
    mode, memory = record.mode[r], record.memory[r]
    for k in range(3):
        evaluate(record.dense[r], 0.5 * k, work)
        numbers[HIGHEST] = max(numbers[HIGHEST], work[at.positions][at.assembly])
        if mode[at.stop] == PUSHING:
            place_bases(blow, record.time[r] + 0.5 * k * record.step[r], work, mode, memory)
            force, _, _ = press(blow.chain, at.stop, work, mode, memory)
            row[STOP_FORCE] = max(row[STOP_FORCE], force)
    row[RETREAT] = numbers[HIGHEST] - numbers[FIRST_PLACE]


@called_kernel
def _sample_blow(blow, record, r, x, weight, notes, work):
    """Write down one sample of a step of a blow, at the fraction x of the step."""
    counts, numbers, at, chain = notes.counts, notes.numbers, layout_of(blow), blow.chain
    row, mode, memory = notes.table[counts[CURRENT]], record.mode[r], record.memory[r]
    t = record.time[r] + x * record.step[r]
    evaluate(record.dense[r], x, work)
    place_bases(blow, t, work, mode, memory)
    pushed = 0.0
    for j in range(at.frame, chain.joins.shape[0]):
        force, _, _ = link_push(chain, j, work, mode, memory)
        pushed += force if j in (at.frame, at.stop) else -force
    if counts[SAMPLES] < notes.samples.shape[1]:
        notes.samples[0, counts[SAMPLES]] = t
        a = pushed / chain.bodies[at.assembly, MASS] + chain.bodies[at.assembly, GRAVITY]
        notes.samples[1, counts[SAMPLES]] = a
        counts[SAMPLES] += 1
        numbers[TOP] = max(numbers[TOP], a)
        counts[FALLEN] = 1 if weight == 0.0 and a < LEVEL * numbers[TOP] else 0
    if weight > 0.0:
        force, _, _ = press(chain, at.contacts.start, work, mode, memory)
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
    at = layout_of(coast)
    place, speed, speed_before = work[at.positions], work[at.speeds], record.dense[:, 0, at.speeds]
    counts[COAST_STEPS] += steps
    if counts[CURRENT] < 0:
        return
    row = notes.table[counts[CURRENT]]
    for r in range(steps):
        mode, memory, dense = record.mode[r], record.memory[r], record.dense[r]
        if mode[at.feed] == RETRACTING:
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
            place_bases(coast, t, work, mode, memory)
            force, _, _ = press(coast.chain, at.stop, work, mode, memory)
            row[STOP_FORCE] = max(row[STOP_FORCE], force)
    if row[CONTACTS] > 0.0:
        row[RETREAT] = numbers[HIGHEST] - numbers[FIRST_PLACE]


@leaf_kernel
def _turning_place(at, dense, work):
    """Return the place at which the object turns back within a step: its speed falls through zero there."""
    low, high = 0.0, 1.0
    for _ in range(30):
        x = 0.5 * (low + high)
        evaluate(dense, x, work)
        if work[at.speeds][OBJECT] > 0.0:
            low = x
        else:
            high = x
    return work[at.positions][OBJECT]


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
