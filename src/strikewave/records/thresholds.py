"""The numbers by which records are judged, each with its reason: a section a subject, shares of the peak unless said.

"Chosen" marks those that rest on judgement alone. Moved down by a fifth and up by a quarter, as
``benchmarks/planted_thresholds.py`` does it, each of the thresholds of the checks changes the findings of one of 138
planted records at most, but for `OfRange.FEWEST_AT_RAIL` (3 where it is moved down, 0 up), `OfTops.OVER` (8, 1),
`OfSampling.FEW` (8, 7), `TOO_FEW` (3, 1) and `NONE_LEFT` (2, 0), `OfNoise.NOTED` (3, 7) and `BESIDE_MAINS` (3, 3), and
`OfZero.BEFORE_A_RESPONSE` (0, 2); `OfSampling.TOP_OF_SPECTRUM` leaves no spectrum where it is moved up.
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
    """Share of a peak that a drifting baseline may falsify before that is suspect: below the usual 5 % of a sensor."""
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
    """Shift that is noted: it may move the velocity change of a half-sine, and its peak, by about 1 %."""
    LARGE_SHIFT: Final = 0.03
    """Shift at which a velocity integrated over ten widths is off by nearly half."""
    LONG_AFTER: Final = 40.0
    """Widths after the blow for a drift of the velocity to be judged: nothing moves then."""
    NOTED_DRIFT: Final = 0.5
    """Drift of the velocity to the end, over the change of velocity, that is noted. Chosen: the integral then says
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
    """Standard errors of a slope before a response, and of a shift after it, that are some: 1 in 1.7 million by chance.
    Chosen larger than for blows, because modes are fitted beside it."""
    CARRIED_ON: Final = 0.5
    """Share of what a drift comes to after the last decay by which what lies there may differ from it: noise with a
    long memory makes slopes before the blow too, which do not go on."""
    FASTEST: Final = 0.3
    """Swings of the strongest mode that the shortest decay of a zero lasts. Chosen: a faster one is part of a swing."""
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
    """Samples of the longest run at a rail that a parabola through both sides may show to be a round top. Chosen: of a
    longer run the samples beside it decide."""
    COARSE: Final = 0.02
    """Half a step of the converter from which on it is worth a word: under half of what harms a figure."""
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
    """Widths after a blow in which what bends its top swings on. Chosen."""
    NOISE_SPANS: Final = 4.0
    """Standard deviations that noise alone swings there, in some thousand samples."""
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
    """Samples of a half-sine at which 0.3 % of its peak may be missed, 1 - cos(pi / (2 n)): below it, it is worth a
    word."""
    TOO_FEW: Final = 10.0
    """The same of 1.2 %, a quarter of what harms a peak."""
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
    """How many times that of the noise it must be. Chosen: the root mean square of a band of white noise is one."""
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
    """Shares of the frequency of the mains at which the record must swing less: hum is a line."""
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
    """Share by which a ringing record swings that is noted. Chosen: what a smaller swing does to a figure is noted by
    `NOTED_EFFECT`."""
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


class OfClock:
    """Time stamps and missing samples."""

    UNEVEN: Final = 0.01
    """Share of a step by which time stamps may stray, besides the rounding of their digits: a jitter that no figure
    shows."""
    JITTER: Final = 0.1
    """Share of a step by which stray stamps harm the spectrum: a phase of 36 degrees at the sampling rate."""
    GAP: Final = 1.5
    """A step longer than this many is a gap: midway between none and one lost sample."""
    MOST_LOST: Final = 0.1
    """A record that lacks more than this share of its samples is bad: straight lines in their place are no
    measurement."""
    USUAL: Final = 0.5
    """Share of the usual step by which others may differ and still count into its mean: gaps and repeated stamps do
    not."""
    MOST_TWICE: Final = 0.4
    """Share of the kept samples whose stamps stand twice beyond which they are no slips of a recorder: of two channels
    that share a column, all do."""
    ROUNDED_STEPS: Final = 0.1
    """Share of steps that are not the usual one beyond which they come from rounded stamps, not from gaps."""
    ODD_STEPS: Final = 0.005
    """Share of steps that are not the usual one up to which stamps are even with a few faults, and not rounded ones."""


class OfReading:
    """What a filter takes off, and which channels answer another one."""

    MUCH: Final = 0.9
    """Share of a peak that a filter must leave for no finding: what it takes off is reported with each peak in any
    case. Chosen: half of a tolerance of 20 %."""
    HALF: Final = 0.5
    """Share that it must leave for one that harms nothing. Chosen: below, the filter makes the pulse."""
    HALF_PERIOD: Final = 0.5
    """Periods of the cutoff that a record must hold: a filter that is slower than the record is a slip of units."""
    SWINGS_OUT: Final = 20.0
    """Median magnitudes that a swing must reach: noise alone reaches seven in a million samples."""


class OfSiblings:
    """A record beside the others of its test."""

    FALSE_ALARM: Final = 0.01
    """Campaigns of normal scatter, without a fault, in which a value is called an outlier; shared by the figures."""
    LEAST_OUTLIER: Final = 0.02
    """Share by which an outlier differs from the median at least: sensors and their mounting are no better."""
    NEAR_FACTOR: Final = 0.05
    """Share by which a ratio may differ from such a factor, or three times the scatter of the others: as much as a peak
    is uncertain by."""
    MOST_NEAR: Final = 0.15
    """The same at most: less than a quarter of the way to the next factor."""
    AGREE: Final = 0.2
    """Scatter of the others over their median up to which they agree, so that one file is the odd one."""
    CLEAR: Final = 5.0
    """Times that scatter by which the odd one differs."""
    SAME_WIDTH: Final = 0.1
    """Share by which the width of a record at another gain differs from the usual: a softer blow lasts longer."""
    NO_BLOW: Final = 20.0
    """Times that the usual peak is the largest excursion of a file without a blow: no test scatters so."""
    LOWER: Final = 3.0
    """Times that the usual peak is an excursion of a file without a blow if it is also as much wider or narrower as
    `OTHER_WIDTH` says, or comes in the period of the mains."""
    OTHER_WIDTH: Final = 3.0
    """Times by which it is wider or narrower then: blows of one test differ less."""
    SHORTER: Final = 0.9
    """A record that lasts less than this share of the usual one is shorter than its siblings, where most last as long:
    one that was stopped by hand."""
    MOST: Final = 0.6
    """Share of the records that last as long then. Where a recorder stops by hand all last differently, and none is
    short."""
    AS_LONG: Final = 0.01
    """Share by which records that last as long may differ: a few samples of a trigger."""
    SAME_RATE: Final = 0.01
    """Share by which sampling rates may differ without a finding: clocks of recorders are good to 1e-4."""


class OfBoxes:
    """What is a blow: boxes that stand out of a record."""

    FALSE_ALARM: Final = 0.01
    """Records of pure noise in which a pulse is found; chosen: one in a hundred, rarer than a record goes wrong
    otherwise."""
    SMALLEST_AREA: Final = 0.2
    """A blow has at least this share of the area of the largest one of its record.

    The blows of one test are alike, and what rings after a blow swings to both sides: the areas of its lobes are
    smaller."""
    SMALLEST_CONTACT: Final = 0.05
    """Share of that area from which on a box may be a rebound, or a blow where a train asks for one."""
    SCALES: Final = 3.0
    """The widths of the blows of one record differ by at most this factor from the largest one: the lobes of a ringing
    are narrower, a drift or a change of level is wider."""
    STANDS_OUT: Final = 2.0
    """A blow is this much higher than what swings before it: a lobe of a ringing has a deeper one before it.

    Chosen: a blow may begin while what was struck before still swings, by less than half of it."""
    APART: Final = 0.3
    """Share of its width around a blow in which no second one is looked for: the feet of a pulse reach beyond its
    box."""
    FEWEST_OF_HITS: Final = 12
    """Samples of a box without which two hits in it cannot be told apart."""
    HUMP: Final = 0.5
    """Share of the higher of two hits that the other reaches. Chosen: below `OfTrains.COMPARABLE`, as means over parts
    of a box round the tops."""
    VALLEY: Final = 0.35
    """Share of the lower of two hits that is left between them at most, to either side of the baseline: half-sines that
    touch foot to foot leave nothing; those 0.9 lengths apart a third."""
    OTHER_SIDE: Final = 0.2
    """Share of the lower of two humps that a ringing reaches to the other side of the baseline around them; hits leave
    less."""
    OTHER_LOBE: Final = 0.45
    """The same to the same side as far away as they lie apart; hits leave their tails there, and less."""
    LOBES: Final = 4.0
    """Widths between two boxes within which both may be lobes of one ringing."""
    TAIL_WIDTHS: Final = 3.0
    """Widths after a hit in which its tail may hold a small box."""
    BESIDE: Final = 3
    """Widths to either side of a box in which a lobe of the other sign makes it one of a ringing: one and a half
    periods."""
    SURE: Final = 3.0
    """Standard deviations of noise taken off such a lobe: what noise alone may be, one in a thousand times."""
    NARROWEST: Final = 3
    """Samples of the narrowest box: a single wild sample, or two, is no blow."""


class OfTrains:
    """Which contacts are blows, and which belong to one; blips of the mains."""

    COMPARABLE: Final = 0.6
    """Share of the peak beside it from which a contact is as large, and no rebound.

    A body that rebounds with a coefficient of restitution of 0.5 strikes again at a half; larger ones are rare in
    metals on test objects, and blows of one machine scatter less."""
    NEAR: Final = 20.0
    """Widths from peak to peak within which a smaller contact belongs to a blow where no train shows what is
    regular."""
    DOUBLE: Final = 5.0
    """Widths from peak to peak within which two contacts as large are a double hit where no train shows what is
    regular."""
    JITTER: Final = 0.15
    """Share of its period by which a gap of a train may differ: machines keep it to some percent, hands do not."""
    MOST_PERIODS: Final = 4
    """Periods that a gap may last: more blows missing in a row are an end of a train and the begin of another."""
    MISSED: Final = 0.5
    """Weights of a usual blow, its peak squared, that a missing one costs a chain.

    Less than one: a train that lacks a blow is else taken for one of twice the period."""
    KNOWN: Final = 0.1
    """Share of that cost once the period is known: a small blow after a gap is then still one of the train."""
    FEWEST_GAPS: Final = 2
    """Gaps of one period without which there is no train."""
    IRREGULAR: Final = 0.35
    """Share of the blows of a train beside which as many contacts of their size, not always as late, show that it is
    none."""
    AS_LATE: Final = 0.15
    """Share by which the lags of rebounds of one train differ at most around their median."""
    SURE_GAPS: Final = 3
    """Gaps of one period with which a gap of several periods is blows that are missing: fewer may be chance."""
    SURE_JITTER: Final = 0.1
    """Their scatter over the period, at most, half of it: then no gap of one period is taken for two."""
    MAINS_SHARE: Final = 0.01
    """Share by which the median gap of blips of the mains differs from such a period."""
    LOCKED: Final = 0.005
    """The same of the mean gap, and of most gaps around it, where nothing else shows that they are blips: grids keep
    their frequency to 0.4 %."""
    CONDUCTS: Final = 0.025
    """Share of a period of 50 or 60 Hz that a blip of the mains lasts at least, 0.5 ms: a rectifier that charges its
    capacitor conducts for 1 to 3 ms. What a switch makes is shorter, but swings to both sides."""


class OfTails:
    """What the zero does after blows: shift, line, decay, AC coupling, or the motion of a machine."""

    QUICK: Final = 3.0
    """Stretches within which a decay is quick: then only its one side tells it from a swing."""
    ONE_SIDE: Final = 0.85
    """Share of the samples of the first of them on its side; else it swings."""
    FEWEST: Final = 6
    """Stretches without which a tail says nothing."""
    PENALTY: Final = 4.0
    """Logarithms of the number of stretches that a parameter must be worth: twice those of the Bayesian criterion,
    because stretches side by side are alike."""
    LEAST_DECAY: Final = 0.5
    """Time constants that a tail must last for its decay to be distinct from a shift."""
    SURE: Final = 6.0
    """Standard errors that a rate of decay must have."""
    SEEN_WHOLE: Final = 3.0
    """Time constants over which a decay is seen whole, to 5 % of it."""
    SURE_WHOLE: Final = 2.5
    """Errors that are enough then, because its amplitude must agree as well."""
    EXPLAINED: Final = 0.8
    """Share of the squares of a tail that AC coupling must explain."""
    TIED: Final = (0.7, 1.4)
    """Bounds of the amplitude of a free exponential over that which its time constant and the velocity demand."""
    AT_ONCE: Final = 3
    """First stretches in which a shift must be there to `HALF_THERE`: what moves begins from zero."""
    HALF_THERE: Final = 0.5
    """Share of a shift that must be there then, and of a tail that a model must explain."""
    REVERSED: Final = 0.25
    """Share of the velocity change by which the velocity after a blow goes to the other side where a machine pushes
    back. What a zero does, shifting, warming or drifting, and a high-pass of first order change the velocity one way
    only."""
    AT_REST: Final = 0.2
    """Share of that to which it comes back: a machine stops what it struck."""
    PUSHED: Final = 5.0
    """Times what the record stands off its zero at last that it is pushed back by at least: where the baseline is off,
    the velocity comes back no faster than that."""


class OfRingingSought:
    """What rings after a blow, and which pulse without its ringing is reported."""

    LOWEST_RATIO: Final = 0.3
    """Swings in a width of the blow below which what follows it is a slow motion, no ringing in it."""
    RINGS: Final = 0.05
    """Share of the peak by which a record swings after a blow, or strays from a smooth pulse in it, before ringing is
    sought."""
    STRAYS: Final = 0.03
    """Misfit of the smooth pulse from which on ringing is sought in it: usual shapes are fitted better."""
    CLEAR: Final = 5.0
    """Standard deviations of noise that ringing swings by at least."""
    SEPARATE: Final = 2.5
    """Swings in a width from which on ringing that is seen in a blow alone is none of its shape: a flat top has
    fewer."""
    NOISE_OF_MISFIT: Final = 1.5
    """Standard deviations of noise that the misfit of the smooth pulse must have: it is made of more."""
    AS_GOOD: Final = 1.5
    """A simpler model is taken where it misses less than this times what the best one misses."""
    ENOUGH: Final = 0.03
    """Misfit within which the simplest model is good enough: by as much the smooth pulse misses sound pulses that are
    none of its family, saw-teeth, flat tops and long tails. What a richer model gains below it, it may have from the
    shape."""
    POOR: Final = 0.12
    """Misfit above which no rigid pulse is reported."""
    BETTER: Final = 0.5
    """Share of what the smooth pulse alone misses that must be left, or there is no ringing to be taken off."""


class OfTwoSensors:
    """Two sensors on one object."""

    SETTLED: Final = 0.1
    """Share of a peak that a window goes on until both channels stay below: what is left moves no delay."""
    CLEAR: Final = 4.0
    """Standard deviations of noise of the same: noise reaches it in one of 16 000 samples."""
    COPY: Final = 0.5
    """Share of the energy of the second channel that a delayed copy of the first must explain, or there is no delay:
    half is a correlation of 0.7."""
    RIVAL: Final = 0.9
    """Share of the largest correlation that another maximum must stay below, or the delay is ambiguous. Chosen."""
    APART: Final = 0.5
    """Share of it that the correlation must fall to between both: noise on one maximum makes no second one."""
    SURE: Final = 0.1
    """Standard uncertainty of a gain within which a line of the transfer function is trusted: chosen, as
    `OfTwoSensors.ALIKE`."""
    ABOVE_NOISE: Final = 10.0
    """Power over that of the noise in both channels that such a line has: noise then moves its gain by about a
    third."""
    CALIBRATED: Final = 0.02
    """Standard uncertainty of the ratio of two sensitivities: shock calibrations state 3 to 5 % for a factor 2 (95
    %)."""
    ALIKE: Final = 0.1
    """Difference of the transfer function from 1 up to which two sensors move as one body."""
    TWICE: Final = 2.0
    """Standard uncertainties beyond which a difference is one (95 %)."""


class OfAnswers:
    """What a channel does after the blow of another one."""

    BOTH_SIDES: Final = 0.5
    """Other side of the peak, over it, from which on a channel swings about zero: a half-sine has 0, a decaying sine at
    a damping ratio of 5 % has 0.85."""
    ZERO_MEAN: Final = 0.2
    """Area over that of the magnitude that it then stays below: a half-sine has 1, that decaying sine less than 0.1."""
    ROUND: Final = 0.5
    """Share of the largest value that its neighbours have in a round top: those of six samples a swing and more."""
    FREE: Final = 0.1
    """Share of the peak magnitude down to which a free decay is followed: below, little is left of it beside the
    noise."""
    CERTAIN: Final = 4.0
    """Standard uncertainties that the amplitude of a mode must have: noise alone gives one in 3000."""
    LOSES: Final = 0.1
    """Share of itself that a swing loses over the stretch, or it does not decay: hum, or what drives the structure
    on."""
    MOST_UNCERTAIN: Final = 0.1
    """Standard uncertainty of a frequency, over itself, beyond which it is none."""
