"""The classes of records: clean ones, and one class a fault, each draw from a seed of its own."""

import zlib
from dataclasses import dataclass, field

import numpy as np

from . import faults
from .drafts import Draft, Setting, add_pulse, quantised
from .noises import COLOURS, noise
from .shapes import draw_shape

SMOOTH = ("half-sine", "haversine", "versed-sine", "leaning", "gamma-like", "contact")
MOST = 40_000
"""Samples of a record."""


@dataclass
class Draw:
    """Some files of one test, and what is known of them.

    Attributes
    ----------
    kind, seed
        Class and number: they give the draw again.
    files : list of Draft
        In the order of the test.
    odd : set of int
        Numbers of files that something must be said of.
    """

    kind: str
    seed: int
    files: list
    odd: set = field(default_factory=set)

    @property
    def clean(self):
        """Whether nothing is wrong."""
        return self.kind.startswith("clean")


def log_uniform(rng, low, high):
    """Return a number whose logarithm is uniform."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def setting(rng, samples=(12, 500), shapes=None, filtered=True):
    """Return how pulses and recorder of a record are: 50 us to 20 ms, 50 g to 50 000 g."""
    width = log_uniform(rng, 50e-6, 20e-3)
    per_width = log_uniform(rng, *samples)
    shape = draw_shape(rng, shapes) if shapes else draw_shape(rng)
    cutoff = rng.uniform(0.15, 0.3) if filtered else 0.0
    return Setting(shape, width, log_uniform(rng, 50.0, 50_000.0), width / per_width, cutoff)


def train(rng, how, count=1, scatter=0.0, period=None, before=None, after=None, missing=None):
    """Return a record with blows in it and nothing else: clean, without noise."""
    length = how.length
    before = rng.uniform(4.0, 40.0) if before is None else before
    after = rng.uniform(8.0, 80.0) if after is None else after
    period = (rng.uniform(10.0, 60.0) if period is None else period) if count > 1 else 0.0
    widths = before + after + (count - 1) * period + 2.0
    shrink = min(1.0, MOST / (widths * length / how.step))  # a fine record is a short one
    before, after = max(before * shrink, 4.0), max(after * shrink, 8.0)
    period = max(period * shrink, 6.0) if count > 1 else 0.0
    size = int((before + after + (count - 1) * period + 1.0) * length / how.step)
    values, blows = np.zeros(size), []
    for k in range(count):
        if k == missing:
            continue
        begin = (before + k * period) * length + (0.005 * period * length * rng.normal() if count > 1 else 0.0)  # fmt: skip
        peak = how.peak * max(1.0 + scatter * rng.normal(), 0.5)
        width = how.width * (1.0 + 0.4 * np.clip(scatter * rng.normal(), -0.2, 0.2))
        blows.append(add_pulse(values, how, begin, peak, width))
    begin_time = -before * length if rng.random() < 0.5 else 0.0
    return Draft(how, values, blows, begin_time=begin_time, period=period * length if count > 1 else np.nan)


def moving(values, count):
    """Return means over so many samples."""
    sums = np.cumsum(np.concatenate([[0.0], values]))
    return (sums[count:] - sums[:-count]) / count


def recorded(rng, draft, decibels=None, colour=None, clean=True, sign=None, bits=None):
    """Add noise, round to the steps of a converter, and turn the record round.

    ``clean`` noise leaves the figures to be known: twice its standard deviation moves the mean over a width, against that
    over the five before it, by 1 % of the peak at most, the mean over a fifth of a width by 2 %, and the width by 2 %;
    where it would be more, the noise is made less.
    """
    decibels = rng.uniform(15.0, 80.0) if decibels is None else decibels
    colour = str(rng.choice(COLOURS, p=[0.55, 0.2, 0.1, 0.15])) if colour is None else colour
    top = max([b.raw_peak for b in draft.blows], default=draft.setting.peak)
    sample = noise(rng, draft.values.size, colour)
    size = faults.level(draft) * 10.0 ** (-decibels / 20.0)
    if clean:
        n = max(round(draft.setting.per_width), 3)
        wander = moving(sample, n)[5 * n :] - moving(sample, 5 * n)[: -n or None][: max(sample.size - 6 * n + 1, 0)]
        tip = max(n // 5, 1)
        short = 2.0 * float(np.std(moving(sample, tip)))
        harm = max(2.0 * float(np.std(wander)) / 0.01, short / 0.02 * max(1.0, draft.setting.shape.width_error))
        size = min(size, faults.level(draft) / harm)
    draft.plain = np.clip(draft.values, -draft.limit, draft.limit)
    draft.values = np.clip(draft.values + size * sample, -draft.limit, draft.limit)
    draft.faults |= {"noise": colour, "decibels": float(20 * np.log10(faults.level(draft) / size))}
    span = rng.uniform(1.15, 8.0) * max(top, float(np.max(np.abs(draft.values))))
    draft.faults["bits"] = int(rng.integers(10, 17)) if bits is None else bits
    draft.values = quantised(draft.values, span, draft.faults["bits"])
    draft.sign = (-1 if rng.random() < 0.1 else 1) if sign is None else sign
    draft.values = draft.sign * draft.values
    return draft


def one_or_several(rng, how=None, most=8, **more):
    """Return a record of one blow, or in three of ten a train."""
    how = how or setting(rng)
    if rng.random() < 0.7:
        return train(rng, how, **more)
    return train(rng, _coarser(how), int(rng.integers(2, most)), rng.uniform(0.005, 0.06), **more)


def _coarser(how, most=60.0):
    """Return a setting with at most so many samples a width."""
    step = max(how.step, how.width / most)
    return Setting(how.shape, how.width, how.peak, step, how.filtered)


def clean_single(rng):
    """One blow."""
    draft = train(rng, setting(rng))
    if rng.random() < 0.5:
        faults.offset(rng, draft, rng.uniform(0.0, 0.04))
    return [recorded(rng, draft)]


def clean_train(rng):
    """2 to 15 blows in a period."""
    draft = train(rng, _coarser(setting(rng)), int(rng.integers(2, 16)), rng.uniform(0.005, 0.08))
    if rng.random() < 0.5:
        faults.offset(rng, draft, rng.uniform(0.0, 0.04))
    return [recorded(rng, draft)]


def campaign(rng, count=None, blows=1, decibels=None, bits=None):
    """Return the drafts of a campaign: alike, with a natural scatter, without noise."""
    how = _coarser(setting(rng), 40.0)
    count = int(rng.integers(5, 52)) if count is None else count
    scatter, before, after = rng.uniform(0.005, 0.06), rng.uniform(8.0, 25.0), rng.uniform(15.0, 50.0)
    drafts = []
    for k in range(count):
        shot = Setting(how.shape, how.width * (1 + 0.3 * scatter * rng.normal()), how.peak * (1 + scatter * rng.normal()), how.step, how.filtered)  # fmt: skip
        draft = train(rng, shot, before=before + rng.uniform(-1, 1), after=after)
        draft.name, draft.begin_time = f"shot_{k + 1:02d}", 0.0
        drafts.append(draft)
    shortest = min(draft.values.size for draft in drafts)  # one recorder, one length
    for draft in drafts:
        draft.cut(0, shortest)
    return drafts


def record_all(rng, drafts, decibels=None):
    """Record a campaign with one recorder."""
    decibels = rng.uniform(30.0, 70.0) if decibels is None else decibels
    colour, bits = str(rng.choice(COLOURS, p=[0.7, 0.1, 0.1, 0.1])), int(rng.integers(12, 17))
    sign = -1 if rng.random() < 0.1 else 1
    return [recorded(rng, draft, decibels, colour, sign=sign, bits=bits) for draft in drafts]


def clean_campaign(rng):
    """5 to 51 files of one blow each."""
    return record_all(rng, campaign(rng))


def emptied(draft):
    """Take the blow out of a draft: the recorder was triggered by nothing."""
    draft.values = np.zeros_like(draft.values)
    draft.blows = []


def some(rng, drafts, most=0.25):
    """Return the numbers of a few files of a campaign, at most so many of them."""
    return sorted(
        int(k) for k in rng.choice(len(drafts), max(1, int(rng.uniform(0, most) * len(drafts))), replace=False)
    )


def campaign_with(change, most=0.25, least=5):
    """Return a class: a campaign some files of which are changed."""

    def draw(rng):
        drafts = campaign(rng, int(rng.integers(least, 52)))
        odd = some(rng, drafts, most)
        for k in odd:
            change(rng, drafts[k])
        return record_all(rng, drafts), set(odd)

    return draw


def hum_only(rng, draft):
    """Leave nothing but hum."""
    emptied(draft)
    faults.hum(rng, draft, 10 ** rng.uniform(-3.5, -1.0))


def mains_blips(rng, draft, period=None):
    """Leave nothing but a short blip of the mains each period."""
    emptied(draft)
    period = 1.0 / float(rng.choice([50.0, 60.0])) if period is None else period
    height = 10 ** rng.uniform(-4.0, -1.5) * draft.setting.peak
    width = rng.uniform(0.03, 0.2) * period
    at = rng.uniform(0, 1) * min(period, draft.time[-1])
    while at < draft.time[-1]:
        draft.values += height * np.exp(-0.5 * ((draft.time - at) / (0.25 * width)) ** 2)
        at += period
    draft.faults["blips"] = height


def blips(rng):
    """Return a record of nothing but blips of the mains, three and more."""
    period = 1.0 / float(rng.choice([50.0, 60.0]))
    step = period / log_uniform(rng, 200, 4000)
    draft = train(rng, Setting(draw_shape(rng), 40 * step, log_uniform(rng, 50.0, 50_000.0), step, 0.0))
    size = int(rng.uniform(3.1, 10.0) * period / step)
    draft.values, draft.zero = np.zeros(size), np.zeros(size)
    mains_blips(rng, draft, period)
    height = draft.faults["blips"]
    draft.setting = Setting(draft.setting.shape, draft.setting.width, height, step, 0.0)
    return [recorded(rng, draft, rng.uniform(20.0, 60.0), clean=False)], {0}


def missing(rng, draft):
    """Leave nothing but noise."""
    emptied(draft)
    draft.faults["no blow"] = True


def half_gain(rng, draft):
    """Set the amplifier to another gain for one shot."""
    factor = float(rng.choice([0.5, 2.0, 0.1, 10.0], p=[0.6, 0.2, 0.1, 0.1]))
    draft.values *= factor
    draft.faults["gain"] = factor


def wrong_polarity(rng, draft):
    """Mount the sensor the other way for one shot."""
    draft.values *= -1.0
    draft.faults["polarity"] = -1


def single_with(change, clean=True, how=None, colour=None, decibels=(30.0, 75.0), **more):
    """Return a class: one record with a fault."""

    def draw(rng):
        draft = one_or_several(rng, how(rng) if how else None, **more)
        change(rng, draft)
        shade = None if colour is None else str(rng.choice(colour))
        return [recorded(rng, draft, rng.uniform(*decibels), shade, clean=clean)], {0}

    return draw


def alone_with(change, how=None, decibels=(30.0, 75.0), **more):
    """Return a class: one record of a single blow with a fault."""

    def draw(rng):
        draft = train(rng, how(rng) if how else setting(rng), **more)
        change(rng, draft)
        return [recorded(rng, draft, rng.uniform(*decibels))], {0}

    return draw


def ring(rng, draft):
    """Ringing that the recorder can follow."""
    ratio = rng.uniform(2.0, 30.0)
    ratio = min(ratio, 0.35 / draft.setting.step * 2.0 * draft.setting.length)  # sampled well enough
    faults.ringing(rng, draft, rng.uniform(0.15, 1.5), max(ratio, 2.0), log_uniform(rng, 5.0, 100.0))


def ring_under_sampled(rng, draft):
    """Above half the sampling rate, and folded down: the recorder has no filter."""
    fastest = 2.0 * draft.setting.length / draft.setting.step
    faults.ringing(rng, draft, rng.uniform(0.15, 1.0), rng.uniform(0.55, 2.5) * fastest, log_uniform(rng, 20.0, 400.0))


def rebound_train(rng):
    """Return a train of 7 or 11 with a rebound after each blow."""
    draft = train(rng, _coarser(setting(rng, (16, 60))), int(rng.choice([7, 11])), rng.uniform(0.005, 0.05), period=rng.uniform(20.0, 60.0))  # fmt: skip
    faults.rebounds(rng, draft, rng.uniform(0.1, 0.4), rng.uniform(0.5, 5.0))
    return [recorded(rng, draft, rng.uniform(35.0, 75.0))], {0}


def double_hit(rng):
    """Two blows of one height, the second a little more than a length after the first; in half of the draws within a train."""
    how = _coarser(setting(rng, (16, 200)))
    draft = train(rng, how, 1 if rng.random() < 0.5 else int(rng.integers(3, 8)), rng.uniform(0.005, 0.03), period=rng.uniform(20.0, 60.0))  # fmt: skip
    k = int(rng.integers(len(draft.blows)))
    first = draft.blows[k]
    apart = rng.uniform(1.2, 2.0)
    blow = add_pulse(
        draft.values, how, first.begin + apart * how.length, first.peak * rng.uniform(0.9, 1.1), first.width
    )
    draft.blows.insert(k + 1, blow)
    draft.faults["apart"] = apart
    draft.period = np.nan
    return [recorded(rng, draft, rng.uniform(35.0, 75.0))], {0}


def missing_in_train(rng):
    """Return a train that lacks one blow, neither the first nor the last."""
    count = int(rng.integers(5, 16))
    k = int(rng.integers(1, count - 1))
    draft = train(rng, _coarser(setting(rng)), count, rng.uniform(0.005, 0.06), missing=k)
    draft.faults["missing blow"] = k + 1
    return [recorded(rng, draft, rng.uniform(35.0, 75.0))], {0}


def cut_off(rng):
    """Begin or end the record within a blow."""
    draft = one_or_several(rng)
    at_end = rng.random() < 0.5
    blow = draft.blows[-1 if at_end else 0]
    place = int((blow.begin + rng.uniform(0.25, 0.8) * (blow.end - blow.begin)) / draft.setting.step)
    draft.cut(*((0, place) if at_end else (place, draft.values.size)))
    draft.faults["cut"] = "end" if at_end else "begin"
    return [recorded(rng, draft, rng.uniform(35.0, 75.0))], {0}


def response_channel(rng):
    """Return a board that swings: some modes that die out, no blow of its own."""
    how = setting(rng, (12, 120))
    draft = train(rng, how, after=rng.uniform(30.0, 120.0))
    begin, time = draft.blows[0].begin, draft.time
    since = np.maximum(time - begin, 0.0)
    draft.values = np.zeros(time.size)
    for k in range(int(rng.integers(1, 6))):
        frequency = log_uniform(rng, 0.5, 8.0) / (2.0 * how.length)
        quality = log_uniform(rng, 8.0, 60.0)
        share = 1.0 if k == 0 else rng.uniform(0.1, 0.8)
        draft.values += share * how.peak * np.exp(-np.pi * frequency * since / quality) * np.sin(2 * np.pi * frequency * since) * rng.choice([-1, 1])  # fmt: skip
    draft.blows = []
    draft.faults["swings"] = True
    return [recorded(rng, draft, rng.uniform(25.0, 70.0))], {0}


def nothing(rng):
    """Noise of any colour, with hum or without: no blow."""
    draft = train(rng, setting(rng))
    draft.values[:] = 0.0
    draft.blows = []
    if rng.random() < 0.5:
        faults.hum(rng, draft, rng.uniform(0.01, 0.5))
    return [recorded(rng, draft, rng.uniform(0.0, 40.0), clean=False)], {0}


CLASSES = {
    "clean-single": clean_single,
    "clean-train": clean_train,
    "clean-campaign": clean_campaign,
    "hum": single_with(lambda rng, d: faults.hum(rng, d, rng.uniform(0.02, 0.3))),
    "hum-files": campaign_with(hum_only),
    "blip-files": campaign_with(mains_blips),
    "gain-files": campaign_with(half_gain, most=0.2),
    "polarity-files": campaign_with(wrong_polarity),
    "missing-files": campaign_with(missing),
    "slow-motion": alone_with(lambda rng, d: faults.slow_motion(rng, d, rng.uniform(0.05, 0.5)), after=200.0),
    "offset": single_with(lambda rng, d: faults.offset(rng, d, 10 ** rng.uniform(-2.0, 0.5))),
    "drift": single_with(lambda rng, d: faults.drift(rng, d, rng.uniform(0.02, 0.6))),
    "zero-step": single_with(lambda rng, d: faults.zero_step(rng, d, rng.uniform(0.02, 0.5))),
    "ac-coupling": single_with(lambda rng, d: faults.ac_coupling(rng, d, 10 ** rng.uniform(-1.0, 2.3))),
    "ringing": single_with(ring),
    "alias-ringing": alone_with(ring_under_sampled, how=lambda rng: setting(rng, (8, 60), filtered=False)),
    "mount-near": single_with(lambda rng, d: faults.mount(rng, d, rng.uniform(0.7, 4.0), log_uniform(rng, 5.0, 100.0))),
    "rebound": alone_with(lambda rng, d: faults.rebounds(rng, d, rng.uniform(0.1, 0.4), rng.uniform(0.5, 5.0)), after=60.0),
    "rebound-train": rebound_train,
    "double-hit": double_hit,
    "missing-in-train": missing_in_train,
    "clipping": single_with(lambda rng, d: faults.clip(rng, d, rng.uniform(0.4, 0.97))),
    "saturation": single_with(lambda rng, d: faults.saturate(rng, d, rng.uniform(0.5, 1.0), rng.uniform(6.0, 20.0))),
    "slew": alone_with(lambda rng, d: faults.slew(rng, d, rng.uniform(0.3, 0.9))),
    "coloured-noise": single_with(lambda rng, d: None, clean=False, colour=COLOURS[1:], decibels=(15.0, 40.0)),
    "strong-noise": single_with(lambda rng, d: None, clean=False, colour=("white",), decibels=(6.0, 25.0)),
    "thermal": single_with(lambda rng, d: faults.thermal(rng, d, 10 ** rng.uniform(-1.3, 0.3))),
    "cut": cut_off,
    "few-samples": single_with(lambda rng, d: None, how=lambda rng: setting(rng, (2.5, 12.0), filtered=rng.random() < 0.5)),
    "response-channel": response_channel,
    "nothing": nothing,
    "mains-blips": blips,
}  # fmt: skip
"""Each class with how it is drawn."""


def draw(kind, seed):
    """Return a draw again, or a new one."""
    rng = np.random.default_rng([zlib.crc32(kind.encode()), seed])
    drawn = CLASSES[kind](rng)
    return Draw(kind, seed, *(drawn if isinstance(drawn, tuple) else (drawn,)))
