"""The numbers by which records are judged, each with its reason: a section a subject, shares of the peak unless said.

Where a reason is an observation, the planted records of ``tests/records`` and of the table in the docs tell both sides
apart; "chosen" marks those that rest on judgement alone.
"""

from __future__ import annotations

from typing import Final

HARMED: Final = 0.05
"""Estimated effect on a figure beyond which it is harmed: the usual uncertainty of a calibrated shock accelerometer."""
NO_EFFECT: Final = 0.0005
"""Effects below which they are not worth a word: less than the digit that is shown."""


class OfBeginning:
    """Whether a record without a blow begins in one, or while something swings."""

    IN_MOTION: Final = 20.0
    """Standard deviations that a beginning spans, or a zero drifts, before it is called unsettled: twice what noise
    spans."""
    FALLS_OFF: Final = 5.0
    """A beginning that spans this many times the end of the record swings; noise, drift and hum span both alike."""
    CUT_BLOW: Final = 4.0
    """`IN_MOTION` is taken over a quarter of what the end spans where a blow is thought to be cut: it rings on until
    then."""
    ONE_SIDED: Final = 0.1
    """A cut blow falls below this share within its part, and swings to the other side by less than this share of
    itself."""
    FAR_OFF: Final = 100.0
    """Scatters that the zero lies off 0 before it is called unsettled without a blow: offsets of tens of them are
    usual."""


class OfZero:
    """Where the zero stands, drifts and shifts."""

    WRONG_PEAK: Final = 0.02
    """What a drifting baseline may falsify of a peak before that is suspect: below the usual 5 % of a sensor."""
    NOTED: Final = 0.05
    """Offset, or drift over the record, that is noted: as much as the usual uncertainty of a peak."""
    LARGE: Final = 0.5
    """Offset at which it swamps the low frequencies of a spectrum, and the range of a recorder was ill used."""
    FEWEST: Final = 16
    """Samples after the blows, or of a level, without which their zero is not judged: its mean is then known to a
    quarter of their scatter."""
    SHIFTED: Final = 3.0
    """Standard errors by which a zero must have shifted, so that chance does it in one record of 400."""
    NOTED_SHIFT: Final = 0.01
    """Shift that is noted: it may move the velocity change of a half-sine by 1 %, and the peak by as much."""
    LARGE_SHIFT: Final = 0.03
    """Shift at which a velocity integrated over ten widths is off by nearly half."""
    LONG_AFTER: Final = 40.0
    """Widths after the blow for a drift of the velocity to be judged: nothing moves then."""
    NOTED_DRIFT: Final = 0.5
    """Drift of the velocity to the end, over the change of velocity, that is noted: chosen, as the integral then says
    little of what moved."""
    LARGE_DRIFT: Final = 2.0
    """The same that is suspect: what is integrated is the zero, not the blow."""
    STEP_OF_SPAN: Final = 0.08
    """Share of the span of a record that a step of its zero is at least: more than a drift or hum makes."""
    STEP_OF_STRAY: Final = 10.0
    """Times what either level strays that such a step is."""
    STRAY_QUANTILE: Final = 0.8
    """Share of the samples of a level that lie within what it strays: blows fill less than the rest."""
    BEFORE_A_RESPONSE: Final = 5.0
    """Standard errors of a slope before a response, and of a shift after it, that are some: 1 in 1.7 million by
    chance, where three of a blow do, as modes and their noise are fitted beside it."""
    CARRIED_ON: Final = 0.5
    """Share of what a drift comes to after the last decay by which what lies there may differ from it: noise with a
    long memory makes slopes before the blow too, which do not go on."""
    FASTEST: Final = 0.3
    """Swings of the strongest mode that the shortest decay of a zero lasts: a faster one is part of a swing."""
    OWN_SIZE: Final = 0.3
    """Share of a decay that is left of the zero without AC coupling of its time constant, or beside it, at most: a
    decay of another kind leaves a shift, as it is not as large as the area before demands."""


class OfRange:
    """Where the range of a recorder ends, and how coarse it is."""

    FEWEST_AT_RAIL: Final = 3
    """Samples at the largest value, and times those in the next two steps, that make a rail: a round top at k steps of
    the converter has about 1 : 0.7 samples in them."""
    NEAR_TOP: Final = 0.05
    """Share of the span below the largest value in which the steps of the converter are looked for: an end of its
    range, where a sound one of 8 bits still has a dozen."""
    OFF_ZERO: Final = 0.01
    """Share of the span, or three steps of the converter, that a rail lies off the zero: the quiet zero is no rail."""
    BESIDE_RAIL: Final = 2.5
    """Steps of the converter below the largest value that count as beside it: the next two."""
    SHORT_RUN: Final = 6
    """Samples of the longest run at a rail that a parabola through both sides may show to be a round top: it stays
    within a step of the converter over a longer one only at coarse steps, which are seen beside it."""
    COARSE: Final = 0.02
    """Half a step of the converter from which on it is worth a word: as with noise, half of what harms a figure."""
    SPIKE: Final = 0.4
    """Share of itself by which a top stands off the cubic through its neighbours: a sine of five samples has 0.32."""


class OfTops:
    """Flat tops and limited slopes of blows."""

    FLATTER: Final = 0.02
    """By how much a top is flatter before it is suspect: the tip of a sin^0.7 is by as much; a limit that takes 5 % off
    a half-sine, a haversine or a pulse of Hertz makes 0.05 to 0.06."""
    TIP_BY_PEAK: Final = 1.8
    """Change of that ratio with the share by which the peak is off: of sin^0.7 to sin^3, 1.81 to 1.62."""
    CORNER: Final = 0.02
    """By how much a top is more pointed than a smooth one before it is a corner: the tip of x exp(-x) is by 0.015."""
    ONE_SLOPE: Final = 0.35
    """Slope of one side over that of the other from which on one limit may have made both, and no saw-tooth is meant.

    Of a saw-tooth that rises over 0.7 of its length and falls as a cosine does it is 0.29."""
    GOES_ON: Final = 0.02
    """By how much a straight side goes on above the peak before its tip counts as bent: as `FLATTER`."""
    SAMPLES_OF_TIP: Final = 2.0
    """Samples on which a recorder's filter rounds the tip of a saw-tooth, or delays it."""
    WRONG: Final = 0.05
    """By how much the half-sine of the flanks is higher than the peak before it is worth a word: as `HARMED`."""
    ALIKE: Final = 0.1
    """Share by which the slopes of two sides differ that one limit makes; their noise is less."""
    SAW_TOOTH: Final = 0.2
    """Slope of one straight side over that of the other below which a pulse is a saw-tooth as standards have it."""
    FEWEST: Final = 6
    """Samples above half of the peak without which the shape of a top is not known: the polynomial through it has as
    many bends."""
    MOST_POINTED: Final = 4.0
    """Power of a sine beyond which pulses that have such flanks have no more pointed tips."""
    SURE: Final = 3.0
    """Standard deviations of noise that a top must be flatter by: chance does it in one record of 700."""
    SWINGS_WITHIN: Final = 2.0
    """Widths after a blow in which what bends its top swings on: a mode that is damped more strongly bends none."""
    NOISE_SPANS: Final = 4.0
    """Standard deviations that noise alone swings there, in some hundred samples."""
    OVER: Final = 0.75
    """Share of the peak over which a side is looked at: a limited slope that falsifies a figure by 5 % holds over 0.77
    of the peak and more, of all pulses planted."""
    STRAIGHT: Final = 0.01
    """Bend of such a side below which it is straight.

    The straightest that a smooth pulse has is that of a haversine, whose cubic is 0.02: of sin x, x within asin(0.75),
    half the coefficient x^3 / 6 times 2/5."""
    FEWEST_OF_FLANK: Final = 6
    """Samples of a side whose bend is known: two more than a cubic has parameters."""


class OfSwings:
    """Flat tops and limited slopes of what swings."""

    FLATTER: Final = 0.12
    """Share of a half swing by which half of the highest tops are flatter than that of a sine: modes together make a
    flat top now and then, but not several alike."""
    FLAT_ALONE: Final = 0.3
    """The same of a top that stands alone."""
    SAME_LEVEL: Final = 0.02
    """Share of the height within which tops are as high as the highest: one limit makes them so."""
    TOP: Final = 0.02
    """Depth below a height, over it, that counts as its top: a sine is there for 13 % of its half swing."""
    NOISES_OF_TOP: Final = 4.0
    """Standard deviations of noise added to that depth: its extremes in some hundred samples of a top."""
    DEEPEST_TOP: Final = 0.5
    """Depth at most, however noisy: below half a height there is no top."""
    HIGH: Final = 0.5
    """Share of the highest top that the tops have which are looked at: a limit that it meets leaves lower ones."""
    LOWER: Final = 0.6
    """Share of the peak below which a limit that takes 5 % off it leaves the samples as they are."""
    FEWEST_OF_TOPS: Final = 4
    """Samples above that, without which there is no top to be compressed."""
    MISSES: Final = 3.0
    """Times what the modes miss of the lower samples that the tops must lack."""
    WORSE: Final = 1.5
    """Times that they must miss of all samples where these are fitted too: a mode that is not known is missed in
    both."""


class OfSampling:
    """Few samples, and what is folded."""

    FEW: Final = 20.0
    """Samples of a half-sine at which 0.3 % of its peak may be missed, 1 - cos(pi / (2 n))."""
    TOO_FEW: Final = 10.0
    """The same of 1.2 %: with noise and baseline it comes near what harms a peak."""
    NONE_LEFT: Final = 5.0
    """The same of 4.9 %: the peak itself is harmed."""
    AROUND: Final = 4.0
    """Widths around the largest blow whose spectrum is looked at: what swings with it, and little noise."""
    TOP_OF_SPECTRUM: Final = 0.85
    """Share of half the sampling rate from which on a spectrum should have fallen off: where anti-alias filters pass
    least."""
    FOLDED: Final = 0.02
    """Share of the largest value that is too much there: 2 % that is folded down may shift a peak by as much."""
    NOISES: Final = 4.0
    """How many times that of the noise it must be: the mean of a band of white noise reaches none of that."""
    OF_AREA: Final = 2.0
    """Times the level at half the sampling rate that folding may do to the area: the largest value of the spectrum is
    about the area of the blow, what is folded lies anywhere down to frequency zero, and twice its root mean square
    covers it."""
    FEW_OF_SWING: Final = 8.0
    """Samples of a swing at which a parabola through three may miss 0.9 % of a top."""
    TOO_FEW_OF_SWING: Final = 6.0
    """The same of 2.6 %; below, no top is round."""
    COUNTS: Final = 0.2
    """Share of the peak that a mode must have for its samples to count: the loss of a smaller one is a fifth of it."""


class OfNoise:
    """Noise and hum beside blows and responses."""

    NOISY: Final = 15.0
    """Ratio of peak to noise, dB, below which a fitted pulse is suspect too: noise of a fifth of the peak."""
    NOTED: Final = 0.02
    """Effect on a figure from which on noise is worth a word: under half of what harms it."""
    NOTED_HUM: Final = 0.01
    """Amplitude of hum from which on it is worth a word: it may lift a peak by as much, and a velocity change by
    several times that."""
    BESIDE_MAINS: Final = (0.62, 0.8, 1.25, 1.6)
    """Of the frequency of the mains, others at which the record must swing less: hum is a line."""
    FEWEST_PERIODS: Final = 1.2
    """Periods of the mains that the quiet parts must span: below, a swing is not distinct from a drift."""
    CLEAR_PERIODS: Final = 2.5
    """The same below which no line is distinct from its neighbours, and the swing must be `SWINGS` from a cubic."""
    SWINGS: Final = 0.1
    """Share of what a cubic leaves of the quiet parts that the swing leaves of them: both have four parameters or
    more."""
    BEFORE_BLOW: Final = 1.0
    """Widths before a blow that are not quiet."""
    AFTER_BLOW: Final = (20.0, 3.0)
    """The same after it: what rings dies out within the first, and where too little is left, within the second if hum
    explains more."""
    EXPLAINED: Final = (0.6, 0.9)
    """Share of the swing of the quiet parts, before the first blow and after it, that hum must explain."""


class OfRinging:
    """What swings after a blow, or without one."""

    AFTER_BLOW: Final = 0.25
    """Widths after the feet of a blow from which on its ringing is taken: beside the foot, before it dies."""
    NOTED: Final = 0.15
    """Share by which a ringing record swings that is noted: it may be three times what harms a peak, but a mount whose
    swing is driven by the pulse itself swings less within it."""
    STRONG: Final = 0.6
    """The same by which the peak itself may be ringing."""
    NOISES: Final = 5.0
    """Standard deviations of noise that it swings by at least: half of what noise spans."""
    NOTED_EFFECT: Final = 0.02
    """Effect of ringing on a figure from which on it is worth a word: as `OfNoise.NOTED`."""
    SEPARATE: Final = 1.5
    """Swings in a width from which on ringing is distinct from the blow without a model: the smooth pulse averages
    it."""
    STRAYS: Final = 0.06
    """Misfit of the smooth pulse that is no usual shape: then the blow itself rings, though it has died out after
    it."""
    SPANS: Final = 6.0
    """Standard deviations by which noise makes a record fall on the way up to a peak, in the thousand samples of a
    side."""
    FOOT: Final = 0.25
    """Widths before a blow that belong to the way up: a contact pushes only, and what begins to the other side
    swings."""
    HIGHER: Final = 5.0
    """Standard deviations that a record goes higher outside the blows than in them: noise alone does not in any
    record."""


class OfBlows:
    """Whether there are blows, whole ones, in a train, and as large as they can be."""

    SPANS_NOISE: Final = 30.0
    """Standard deviations beyond which a record without a blow holds something: noise spans ten in a million
    samples."""
    PART: Final = 0.1
    """From which on what a record begins or ends in, and falls off from, is a part of another blow: above the feet of
    whole ones."""
    FEWEST_OF_PART: Final = 3
    """Samples of a width of such a part: fewer are no shape."""
    MISSED_FALL: Final = 0.9
    """Share of the speed of a fall that is the least change of velocity: 10 % is left to friction of guides and the
    height."""
    DUE: Final = 1.25
    """Periods of the mains before the first blow, or after the last, that hold a place where a blip is due: one and a
    quarter, because a blip that the record cuts is not seen."""
    EVEN: Final = 0.02
    """Share of their height by which blips of the mains scatter at most where no noise moves them: what samples miss of
    a peak."""
    IN_TIME: Final = 0.001
    """The same of their period: what a grid changes in a second."""
    UNSURE: Final = 3.0
    """Standard uncertainties within which they may scatter by their noise."""


class OfResponses:
    """Whether a channel answers the blow of another one."""

    STANDS_OUT: Final = 8.0
    """Standard deviations of what lies before that a response must reach: noise alone reaches five in a million
    samples."""
    OVER_BEFORE: Final = 2.0
    """Times the largest value before the blow that a response must reach: what goes on as before is no answer."""
