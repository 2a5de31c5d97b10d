"""What can be wrong with a record. Each takes a draft and a strength and changes its values, never its truth."""

from dataclasses import replace

import numpy as np
from scipy.signal import lfilter

from .drafts import add_pulse


def level(draft):
    """Return the peak that strengths are shares of."""
    return draft.blows[0].peak if draft.blows else draft.setting.peak


def hum(rng, draft, strength):
    """Add the mains and a third harmonic."""
    frequency = float(rng.choice([50.0, 60.0]))
    phase = rng.uniform(0, 2 * np.pi)
    third = rng.uniform(0.0, 0.3)
    angle = 2 * np.pi * frequency * draft.time + phase
    draft.lift(strength * level(draft) * (np.sin(angle) + third * np.sin(3 * angle + rng.uniform(0, 6))))
    draft.faults["hum"] = strength


def slow_motion(rng, draft, strength):
    """Move slowly from the end of the blow on; before it all is quiet."""
    blow = draft.blows[-1]
    since = np.maximum(draft.time - blow.end, 0.0) / blow.width
    period, decay = rng.uniform(20.0, 200.0), rng.uniform(20.0, 300.0)
    draft.values += rng.choice([-1, 1]) * strength * level(draft) * np.sin(2 * np.pi * since / period) * np.exp(-since / decay)  # fmt: skip
    draft.faults["slow-motion"] = strength


def offset(rng, draft, strength):
    """Add a constant."""
    draft.lift(np.full(draft.values.size, rng.choice([-1, 1]) * strength * level(draft)))
    draft.faults["offset"] = strength


def drift(rng, draft, strength):
    """Add a straight drift over the record, by so much of the peak from end to end."""
    draft.lift(rng.choice([-1, 1]) * strength * level(draft) * draft.time / draft.time[-1])
    draft.faults["drift"] = strength


def zero_step(rng, draft, strength):
    """Shift the zero of the sensor while it is struck, for good."""
    blow = draft.blows[int(rng.integers(len(draft.blows)))]
    share = np.clip((draft.time - blow.begin) / (blow.time - blow.begin) * rng.uniform(0.5, 1.0), 0.0, 1.0)
    share[draft.time >= blow.time] = 1.0
    draft.values += rng.choice([-1, 1]) * strength * level(draft) * share
    draft.faults["zero-step"] = strength


def ac_coupling(rng, draft, cutoff):
    """Take a high-pass of first order, Hz."""
    decay = np.exp(-2 * np.pi * cutoff * draft.setting.step)
    draft.values = lfilter([0.5 + 0.5 * decay, -(0.5 + 0.5 * decay)], [1.0, -decay], draft.values)
    draft.faults["ac-coupling"] = cutoff


def ringing(rng, draft, strength, ratio, quality):
    """Let something ring from the begin of each blow on, and die out.

    ``ratio`` is its frequency over that of the pulse, 1/(2 lengths); the record may be too slow for it.
    """
    frequency = ratio / (2.0 * draft.setting.length)
    blows = []
    for blow in draft.blows:
        phase = rng.uniform(-0.3, 0.3)
        since = np.maximum(draft.time - blow.begin, 0.0)
        grown = 1.0 - np.exp(-since * frequency * 4.0)
        swing = strength * blow.peak * grown * np.exp(-np.pi * frequency * since / quality) * np.sin(2 * np.pi * frequency * since + phase)  # fmt: skip
        draft.values += np.where(draft.time > blow.begin, swing, 0.0)
        inside = (draft.time >= blow.begin) & (draft.time <= blow.end)
        blows.append(replace(blow, raw_peak=float(np.max(draft.values[inside], initial=0.0))))
    draft.blows = blows
    draft.faults |= {"ringing": strength, "ringing frequency": frequency, "quality": quality}


def mount(rng, draft, ratio, quality):
    """Put the sensor on a mount of one degree of freedom, whose absolute acceleration it records."""
    frequency = ratio / (2.0 * draft.setting.length)
    step = draft.setting.step
    fineness = max(int(np.ceil(24 * frequency * step)), 1)
    time = np.arange(draft.values.size * fineness) * step / fineness
    drive = np.interp(time, draft.time, draft.values)
    omega, damping = 2 * np.pi * frequency, 0.5 / quality
    # ramp-invariant would be finer; Tustin at 24 points a period and more, pre-warped, is good to a percent
    k = omega / np.tan(0.5 * omega * step / fineness)
    a = np.array([k * k + 2 * damping * omega * k + omega**2, 2 * omega**2 - 2 * k * k, k * k - 2 * damping * omega * k + omega**2])  # fmt: skip
    b = np.array([2 * damping * omega * k + omega**2, 2 * omega**2, omega**2 - 2 * damping * omega * k])
    draft.values = lfilter(b / a[0], a / a[0], drive)[::fineness]
    blows = []
    for blow in draft.blows:
        inside = (draft.time >= blow.begin) & (draft.time <= blow.end + blow.width)
        blows.append(replace(blow, raw_peak=float(np.max(draft.values[inside], initial=0.0))))
    draft.blows = blows
    draft.faults |= {"mount ratio": ratio, "quality": quality}


def rebounds(rng, draft, strength, gap):
    """After each blow a smaller one, so many widths after its end."""
    for blow in draft.blows:
        width = blow.width * rng.uniform(0.8, 1.5)
        height = strength * blow.peak * rng.uniform(0.9, 1.1)
        add_pulse(draft.values, draft.setting, blow.end + gap * blow.width * rng.uniform(0.95, 1.05), height, width)
    draft.faults |= {"rebound": strength, "gap": gap}


def clip(rng, draft, share):
    """End the range of the recorder at so much of the largest peak: what it adds comes before."""
    draft.limit = share * max(blow.raw_peak for blow in draft.blows)
    draft.faults["clipped at"] = share


def saturate(rng, draft, share, sharpness):
    """Bend towards the limit of an amplifier, the harder the sharper."""
    limit = share * max(blow.raw_peak for blow in draft.blows)
    draft.values = draft.values / (1.0 + (np.abs(draft.values) / limit) ** sharpness) ** (1.0 / sharpness)
    draft.faults |= {"saturates at": share, "sharpness": sharpness}


def slew(rng, draft, share):
    """Follow at most so much of the steepest slope of the pulse."""
    slopes = np.diff(draft.values)
    most = share * float(np.max(np.abs(slopes)))
    values, now = draft.values.copy(), draft.values[0]
    for k in range(1, values.size):
        now += min(max(values[k] - now, -most), most)
        values[k] = now
    draft.values = values
    draft.faults["slew"] = share


def thermal(rng, draft, strength):
    """Warm the sensor before: its zero decays through the record."""
    decay = 10 ** rng.uniform(-1.0, 0.7) * draft.time[-1]
    draft.lift(rng.choice([-1, 1]) * strength * level(draft) * np.exp(-draft.time / decay))
    draft.faults |= {"thermal": strength, "decay": decay}
