"""The numbers by which records are judged, each with its reason: a section a subject, shares of the peak unless said.

"Chosen" marks those that rest on judgement alone. Moved down by a fifth and up by a quarter, as
``benchmarks/planted_thresholds.py`` does it, each of the thresholds of the checks changes the findings of one of 138
planted records at most, but for `OfRange.FEWEST_AT_RAIL` (3 where it is moved down, 0 up), `OfTops.OVER` (8, 1),
`OfSampling.FEW` (8, 7), `TOO_FEW` (3, 1) and `NONE_LEFT` (2, 0), `OfNoise.NOTED` (3, 7) and `BESIDE_MAINS` (3, 3), and
`OfZero.BEFORE_A_RESPONSE` (0, 2); `OfSampling.TOP_OF_SPECTRUM` leaves no spectrum where it is moved up.
"""

from __future__ import annotations

from typing import Final

# Estimated effect on a figure beyond which it is harmed: the usual uncertainty of a calibrated shock accelerometer
HARMED: Final = 0.05
NO_EFFECT: Final = 0.0005  # effects below which they are not worth a word: less than the digit that is shown


class OfBeginning:
    """Thresholds for a record without a blow that begins in one, or while something swings."""

    # Deviations that a beginning spans, or a zero drifts, when unsettled: twice what noise spans
    IN_MOTION: Final = 20.0
    # A beginning that spans this many times the end of the record swings; noise, drift and hum span both alike
    FALLS_OFF: Final = 5.0
    CUT_BLOW: Final = 4.0  # `IN_MOTION` over a quarter of the end's span, where a cut blow rings on
    # A cut blow falls below this share within its part, and swings to the other side by less than this share of itself
    ONE_SIDED: Final = 0.1
    # Scatters that the zero lies off 0 before it is called unsettled without a blow: offsets of tens of them are usual
    FAR_OFF: Final = 100.0


class OfZero:
    """Thresholds for the zero: offset, drift and shift."""

    # Share of a peak that a drifting baseline may falsify before that is suspect: below the usual 5 % of a sensor
    WRONG_PEAK: Final = 0.02
    NOTED: Final = 0.05  # offset, or drift over the record, that is noted: as much as the usual uncertainty of a peak
    # Offset at which it swamps the low frequencies of a spectrum, and the range of a recorder was ill used
    LARGE: Final = 0.5
    FEWEST: Final = 16  # samples of a level that is judged: its mean is then known to a quarter of their scatter
    # Standard errors by which a zero must have shifted, so that chance does it in one record of 400
    SHIFTED: Final = 3.0
    # Shift that is noted: it may move the velocity change of a half-sine, and its peak, by about 1 %
    NOTED_SHIFT: Final = 0.01
    LARGE_SHIFT: Final = 0.03  # shift at which a velocity integrated over ten widths is off by nearly half
    LONG_AFTER: Final = 40.0  # widths after the blow for a drift of the velocity to be judged: nothing moves then
    NOTED_DRIFT: Final = 0.5  # drift of the velocity, over its change, that is noted. Chosen: the integral says little
    LARGE_DRIFT: Final = 2.0  # the same that is suspect: what is integrated is the zero, not the blow
    # Share of the span of a record that a step of its zero is at least: more than a drift or hum makes
    STEP_OF_SPAN: Final = 0.08
    STEP_OF_STRAY: Final = 10.0  # times what either level strays that such a step is
    # Share of the samples of a level that lie within what it strays: blows fill less than the rest
    STRAY_QUANTILE: Final = 0.8
    # Standard errors of slope and shift: chance 1 in 1.7 million, as modes are fitted too
    BEFORE_A_RESPONSE: Final = 5.0
    CARRIED_ON: Final = 0.5  # share by which the end may differ from a drift: noise with memory slopes too, and stops
    # Swings of the strongest mode that the shortest decay of a zero lasts. Chosen: a faster one is part of a swing
    FASTEST: Final = 0.3
    OWN_SIZE: Final = 0.3  # share of a decay left without AC coupling: another kind of decay leaves a shift


class OfRange:
    """Thresholds for the range of a recorder and its resolution."""

    FEWEST_AT_RAIL: Final = 3  # samples at a rail, and times those of the next two steps: a round top has 1 : 0.7
    NEAR_TOP: Final = 0.05  # share of the span where converter steps are sought: a sound 8-bit top has a dozen in it
    # Share of the span, or three steps of the converter, that a rail lies off the zero: the quiet zero is no rail
    OFF_ZERO: Final = 0.01
    BESIDE_RAIL: Final = 2.5  # steps of the converter below the largest value that count as beside it: the next two
    SHORT_RUN: Final = 6  # samples at a rail that may be a round top; of longer runs the samples beside decide. Chosen
    # Half a step of the converter from which on it is worth a word: under half of what harms a figure
    COARSE: Final = 0.02
    # Share of itself by which a top stands off the cubic through its neighbours: a sine of five samples has 0.32
    SPIKE: Final = 0.4


class OfTops:
    """Flat tops and limited slopes of blows."""

    # Excess flatness that is suspect: sin^0.7 has as much; a limit that takes 5 % makes 0.05-0.06
    FLATTER: Final = 0.02
    # Change of that ratio with the share by which the peak is off: of sin^0.7 to sin^3, 1.81 to 1.62
    TIP_BY_PEAK: Final = 1.8
    # By how much a top is more pointed than a smooth one before it is a corner: the tip of x exp(-x) is by 0.015
    CORNER: Final = 0.02
    # Slope of one side over that of the other from which on one limit may have made both, and no saw-tooth is meant. Of
    # a saw-tooth that rises over 0.7 of its length and falls as a cosine does it is 0.29.
    ONE_SLOPE: Final = 0.35
    # By how much a straight side goes on above the peak before its tip counts as bent: as `FLATTER`
    GOES_ON: Final = 0.02
    SAMPLES_OF_TIP: Final = 2.0  # samples on which a recorder's filter rounds the tip of a saw-tooth, or delays it
    # By how much the half-sine of the flanks is higher than the peak before it is worth a word: as `HARMED`
    WRONG: Final = 0.05
    ALIKE: Final = 0.1  # share by which the slopes of two sides differ that one limit makes; their noise is less
    # Slope of one straight side over that of the other below which a pulse is a saw-tooth as standards have it
    SAW_TOOTH: Final = 0.2
    FEWEST: Final = 6  # samples above half of the peak that show a top: the polynomial through it has as many bends
    MOST_POINTED: Final = 4.0  # power of a sine beyond which pulses that have such flanks have no more pointed tips
    SURE: Final = 3.0  # standard deviations of noise that a top must be flatter by: chance does it in one record of 700
    SWINGS_WITHIN: Final = 2.0  # widths after a blow in which what bends its top swings on. Chosen
    NOISE_SPANS: Final = 4.0  # standard deviations that noise alone swings there, in some thousand samples
    OVER: Final = 0.75  # share of the peak of a side that is looked at: a slope limit that costs 5 % holds over 0.77
    # Bend of such a side below which it is straight. The straightest that a smooth pulse has is that of a haversine,
    # whose cubic is 0.02: of sin x, x within asin(0.75), half the coefficient x^3 / 6 times 2/5.
    STRAIGHT: Final = 0.01
    FEWEST_OF_FLANK: Final = 6  # samples of a side whose bend is known: two more than a cubic has parameters


class OfSwings:
    """Flat tops and limited slopes of what swings."""

    FLATTER: Final = 0.12  # excess flatness of half of the highest tops: modes make one flat top, not several alike
    FLAT_ALONE: Final = 0.3  # the same of a top that stands alone
    # Share of the height within which tops are as high as the highest: one limit makes them so
    SAME_LEVEL: Final = 0.02
    # Depth below a height, over it, that counts as its top: a sine is there for 13 % of its half swing
    TOP: Final = 0.02
    # Standard deviations of noise added to that depth: its extremes in some hundred samples of a top
    NOISES_OF_TOP: Final = 4.0
    DEEPEST_TOP: Final = 0.5  # depth at most, however noisy: below half a height there is no top
    # Share of the highest top that the tops have which are looked at: a limit that it meets leaves lower ones
    HIGH: Final = 0.5
    LOWER: Final = 0.6  # share of the peak below which a limit that takes 5 % off it leaves the samples as they are
    FEWEST_OF_TOPS: Final = 4  # samples above that, without which there is no top to be compressed
    MISSES: Final = 3.0  # times what the modes miss of the lower samples that the tops must lack
    # Times that they must miss of all samples where these are fitted too: a mode that is not known is missed in both
    WORSE: Final = 1.5


class OfSampling:
    """Few samples, and what is folded."""

    # Samples of a half-sine at which 0.3 % of its peak may be missed, 1 - cos(pi / (2 n)): below it, it is worth a word
    FEW: Final = 20.0
    TOO_FEW: Final = 10.0  # the same of 1.2 %, a quarter of what harms a peak
    NONE_LEFT: Final = 5.0  # the same of 4.9 %: the peak itself is harmed
    # Widths around the largest blow whose spectrum is looked at: what swings with it, and little noise
    AROUND: Final = 4.0
    TOP_OF_SPECTRUM: Final = 0.85  # share of half the sampling rate where anti-alias filters pass least
    # Share of the largest value that is too much there: 2 % that is folded down may shift a peak by as much
    FOLDED: Final = 0.02
    # How many times that of the noise it must be. Chosen: the root mean square of a band of white noise is one
    NOISES: Final = 4.0
    # Times the level at half the sampling rate that folding may do to the area: the largest value of the spectrum is
    # about the area of the blow, what is folded lies anywhere down to frequency zero, and twice its root mean square
    # covers it.
    OF_AREA: Final = 2.0
    FEW_OF_SWING: Final = 8.0  # samples of a swing at which a parabola through three may miss 0.9 % of a top
    TOO_FEW_OF_SWING: Final = 6.0  # the same of 2.6 %; below, no top is round
    # Share of the peak that a mode must have for its samples to count: the loss of a smaller one is a fifth of it
    COUNTS: Final = 0.2


class OfNoise:
    """Noise and hum beside blows and responses."""

    # Ratio of peak to noise, dB, below which a fitted pulse is suspect too: noise of a fifth of the peak
    NOISY: Final = 15.0
    NOTED: Final = 0.02  # effect on a figure from which on noise is worth a word: under half of what harms it
    NOTED_HUM: Final = 0.01  # amplitude of hum that is noted: a peak rises by as much, a velocity change by more
    # Shares of the frequency of the mains at which the record must swing less: hum is a line
    BESIDE_MAINS: Final = (0.62, 0.8, 1.25, 1.6)
    # Periods of the mains that the quiet parts must span: below, a swing is not distinct from a drift
    FEWEST_PERIODS: Final = 1.2
    # The same below which no line is distinct from its neighbours, and the swing must be `SWINGS` from a cubic
    CLEAR_PERIODS: Final = 2.5
    # Share of what a cubic leaves of the quiet parts that the swing leaves of them: both have four parameters or more
    SWINGS: Final = 0.1
    BEFORE_BLOW: Final = 1.0  # widths before a blow that are not quiet
    AFTER_BLOW: Final = (20.0, 3.0)  # widths after it: ringing dies out in the first; the second if room is short
    # Share of the swing of the quiet parts, before the first blow and after it, that hum must explain
    EXPLAINED: Final = (0.6, 0.9)


class OfRinging:
    """Thresholds for swings after a blow, or without one."""

    # Widths after the feet of a blow from which on its ringing is taken: beside the foot, before it dies
    AFTER_BLOW: Final = 0.25
    NOTED: Final = 0.15  # swing that is noted. Chosen: effects of smaller swings are noted by `NOTED_EFFECT`
    STRONG: Final = 0.6  # the same by which the peak itself may be ringing
    NOISES: Final = 5.0  # standard deviations of noise that it swings by at least: half of what noise spans
    NOTED_EFFECT: Final = 0.02  # effect of ringing on a figure from which on it is worth a word: as `OfNoise.NOTED`
    # Swings in a width from which on ringing is distinct from the blow without a model: the smooth pulse averages it
    SEPARATE: Final = 1.5
    # Misfit of the smooth pulse that is no usual shape: then the blow itself rings, though it has died out after it
    STRAYS: Final = 0.06
    # Standard deviations by which noise makes a record fall on the way up to a peak, in the thousand samples of a side
    SPANS: Final = 6.0
    # Widths before a blow that belong to the way up: a contact pushes only, and what begins to the other side swings
    FOOT: Final = 0.25
    # Standard deviations that a record goes higher outside the blows than in them: noise alone does not in any record
    HIGHER: Final = 5.0


class OfBlows:
    """Thresholds for blows: present, whole, in a train, and as large as they can be."""

    # Standard deviations beyond which a record without a blow holds something: noise spans ten in a million samples
    SPANS_NOISE: Final = 30.0
    PART: Final = 0.1  # share of the peak that makes a cut end part of another blow: feet of whole ones are lower
    FEWEST_OF_PART: Final = 3  # samples of a width of such a part: fewer are no shape
    MISSED_FALL: Final = 0.9  # least velocity change over the speed of a fall: 10 % for friction of guides and height
    DUE: Final = 1.25  # periods that surely hold a due blip: one and a quarter, as a cut blip is not seen
    EVEN: Final = 0.02  # scatter of heights of noiseless blips of the mains: what samples miss of a peak
    IN_TIME: Final = 0.001  # the same of their period: what a grid changes in a second
    UNSURE: Final = 3.0  # standard uncertainties within which they may scatter by their noise


class OfResponses:
    """Thresholds for the response of a channel to the blow of another one."""

    # Standard deviations of what lies before that a response must reach: noise alone reaches five in a million samples
    STANDS_OUT: Final = 8.0
    # Times the largest value before the blow that a response must reach: what goes on as before is no answer
    OVER_BEFORE: Final = 2.0


class OfClock:
    """Time stamps and missing samples."""

    UNEVEN: Final = 0.01  # share of a step by which stamps stray beyond their rounding: no figure shows it
    # Share of a step by which stray stamps harm the spectrum: a phase of 36 degrees at the sampling rate
    JITTER: Final = 0.1
    GAP: Final = 1.5  # a step longer than this many is a gap: midway between none and one lost sample
    # A record that lacks more than this share of its samples is bad: straight lines in their place are no measurement
    MOST_LOST: Final = 0.1
    # Share of the usual step by which others may differ and still count into its mean: gaps and repeated stamps do not
    USUAL: Final = 0.5
    MOST_TWICE: Final = 0.4  # share of stamps that stand twice by slips: of two channels in one column all do
    # Share of steps that are not the usual one beyond which they come from rounded stamps, not from gaps
    ROUNDED_STEPS: Final = 0.1
    # Share of steps that are not the usual one up to which stamps are even with a few faults, and not rounded ones
    ODD_STEPS: Final = 0.005


class OfReading:
    """Thresholds for the share that a filter takes off, and for channels that respond to another one."""

    MUCH: Final = 0.9  # share of a peak that a filter must leave unnoticed. Chosen: half of a 20 % tolerance
    HALF: Final = 0.5  # share that it must leave for one that harms nothing. Chosen: below, the filter makes the pulse
    # Periods of the cutoff that a record must hold: a filter that is slower than the record is a slip of units
    HALF_PERIOD: Final = 0.5
    # Median magnitudes that a swing must reach: noise alone reaches seven in a million samples
    SWINGS_OUT: Final = 20.0


class OfSiblings:
    """A record beside the others of its test."""

    # Campaigns of normal scatter, without a fault, in which a value is called an outlier; shared by the figures
    FALSE_ALARM: Final = 0.01
    # Share by which an outlier differs from the median at least: sensors and their mounting are no better
    LEAST_OUTLIER: Final = 0.02
    NEAR_FACTOR: Final = 0.05  # distance of a ratio from a gain factor: as much as a peak is uncertain by
    MOST_NEAR: Final = 0.15  # the same at most: less than a quarter of the way to the next factor
    # Scatter of the others over their median up to which they agree, so that one file is the odd one
    AGREE: Final = 0.2
    CLEAR: Final = 5.0  # times that scatter by which the odd one differs
    # Share by which the width of a record at another gain differs from the usual: a softer blow lasts longer
    SAME_WIDTH: Final = 0.1
    # Times that the usual peak is the largest excursion of a file without a blow: no test scatters so
    NO_BLOW: Final = 20.0
    LOWER: Final = 3.0  # the same for a file that also fails `OTHER_WIDTH`, or comes in the period of the mains
    OTHER_WIDTH: Final = 3.0  # times by which it is wider or narrower then: blows of one test differ less
    SHORTER: Final = 0.9  # share of the usual duration below which a record was stopped by hand
    MOST: Final = 0.6  # share of records that last alike: where a hand stops them none is short
    AS_LONG: Final = 0.01  # share by which records that last as long may differ: a few samples of a trigger
    # Share by which sampling rates may differ without a finding: clocks of recorders are good to 1e-4
    SAME_RATE: Final = 0.01


class OfBoxes:
    """Thresholds for blows: boxes that stand out of a record."""

    FALSE_ALARM: Final = 0.01  # records of pure noise with a pulse. Chosen: rarer than a record goes wrong otherwise
    # Least area of a blow over the largest: blows of a test are alike, lobes of ringing smaller
    SMALLEST_AREA: Final = 0.2
    # Share of that area from which on a box may be a rebound, or a blow where a train asks for one
    SMALLEST_CONTACT: Final = 0.05
    SCALES: Final = 3.0  # ratio of widths of blows of a record: lobes of ringing are narrower, drifts wider
    STANDS_OUT: Final = 2.0  # times a blow is higher than the swing before it: a lobe has a deeper one. Chosen
    # Share of its width around a blow in which no second one is looked for: the feet of a pulse reach beyond its box
    APART: Final = 0.3
    FEWEST_OF_HITS: Final = 12  # samples of a box without which two hits in it cannot be told apart
    HUMP: Final = 0.5  # share of the higher of two hits. Chosen: below `OfTrains.COMPARABLE`, as means round tops
    VALLEY: Final = 0.35  # share of the lower hit left between two: half-sines 0.9 lengths apart leave a third
    OTHER_SIDE: Final = 0.2  # share of the lower hump that ringing reaches on the other side; hits leave less
    # The same to the same side as far away as they lie apart; hits leave their tails there, and less
    OTHER_LOBE: Final = 0.45
    LOBES: Final = 4.0  # widths between two boxes within which both may be lobes of one ringing
    TAIL_WIDTHS: Final = 3.0  # widths after a hit in which its tail may hold a small box
    # Widths to either side of a box in which a lobe of the other sign makes it one of a ringing: one and a half periods
    BESIDE: Final = 3
    # Standard deviations of noise taken off such a lobe: what noise alone may be, one in a thousand times
    SURE: Final = 3.0
    NARROWEST: Final = 3  # samples of the narrowest box: a single wild sample, or two, is no blow


class OfTrains:
    """Thresholds for contacts that are blows or belong to one; blips of the mains."""

    COMPARABLE: Final = 0.6  # peak over its neighbour's that is no rebound: a restitution of 0.5 gives half
    # Widths from peak to peak within which a smaller contact belongs to a blow where no train shows what is regular
    NEAR: Final = 20.0
    # Widths from peak to peak within which two contacts as large are a double hit where no train shows what is regular
    DOUBLE: Final = 5.0
    # Share of its period by which a gap of a train may differ: machines keep it to some percent, hands do not
    JITTER: Final = 0.15
    # Periods that a gap may last: more blows missing in a row are an end of a train and the begin of another
    MOST_PERIODS: Final = 4
    MISSED: Final = 0.5  # usual blows that a missing one costs: at one, a gap would double the period
    # Share of that cost once the period is known: a small blow after a gap is then still one of the train
    KNOWN: Final = 0.1
    FEWEST_GAPS: Final = 2  # gaps of one period without which there is no train
    IRREGULAR: Final = 0.35  # share of equal contacts beside a train, not equally late, that refute it. Chosen
    AS_LATE: Final = 0.15  # share by which the lags of rebounds of one train differ at most around their median
    # Gaps of one period with which a gap of several periods is blows that are missing: fewer may be chance
    SURE_GAPS: Final = 3
    # Their scatter over the period, at most, half of it: then no gap of one period is taken for two
    SURE_JITTER: Final = 0.1
    MAINS_SHARE: Final = 0.01  # share by which the median gap of blips of the mains differs from such a period
    LOCKED: Final = 0.005  # the same of the mean gap where nothing else shows blips: grids keep 0.4 %
    CONDUCTS: Final = 0.025  # share of a period that a blip lasts: a rectifier conducts 1-3 ms, a switch is shorter


class OfTails:
    """Thresholds for the zero after blows: shift, line, decay, AC coupling, or the motion of a machine."""

    QUICK: Final = 3.0  # stretches within which a decay is quick: then only its one side tells it from a swing
    ONE_SIDE: Final = 0.85  # share of the samples of the first of them on its side; else it swings
    FEWEST: Final = 6  # stretches without which a tail says nothing
    PENALTY: Final = 4.0  # cost of a parameter in log n: twice the Bayesian one, as neighbours are alike
    LEAST_DECAY: Final = 0.5  # time constants that a tail must last for its decay to be distinct from a shift
    SURE: Final = 6.0  # standard errors that a rate of decay must have
    SEEN_WHOLE: Final = 3.0  # time constants over which a decay is seen whole, to 5 % of it
    SURE_WHOLE: Final = 2.5  # errors that are enough then, because its amplitude must agree as well
    EXPLAINED: Final = 0.8  # share of the squares of a tail that AC coupling must explain
    # Bounds of the amplitude of a free exponential over that which its time constant and the velocity demand
    TIED: Final = (0.7, 1.4)
    AT_ONCE: Final = 3  # first stretches in which a shift must be there to `HALF_THERE`: what moves begins from zero
    HALF_THERE: Final = 0.5  # share of a shift that must be there then, and of a tail that a model must explain
    REVERSED: Final = 0.25  # share by which a machine turns the velocity back: a zero or a high-pass moves it one way
    AT_REST: Final = 0.2  # share of that to which it comes back: a machine stops what it struck
    PUSHED: Final = 5.0  # times the last offset that a push back is: a wrong baseline makes it no faster


class OfRingingSought:
    """Thresholds for ringing after a blow, and for the reported pulse without its ringing."""

    # Swings in a width of the blow below which what follows it is a slow motion, no ringing in it
    LOWEST_RATIO: Final = 0.3
    RINGS: Final = 0.05  # share of the peak that swings, or strays from a smooth pulse, before ringing is sought
    # Misfit of the smooth pulse from which on ringing is sought in it: usual shapes are fitted better
    STRAYS: Final = 0.03
    CLEAR: Final = 5.0  # standard deviations of noise that ringing swings by at least
    # Swings in a width from which on ringing that is seen in a blow alone is none of its shape: a flat top has fewer
    SEPARATE: Final = 2.5
    # Standard deviations of noise that the misfit of the smooth pulse must have: it is made of more
    NOISE_OF_MISFIT: Final = 1.5
    AS_GOOD: Final = 1.5  # a simpler model is taken where it misses less than this times what the best one misses
    ENOUGH: Final = 0.03  # misfit of the simplest model that will do: sound saw-teeth and flat tops miss as much
    POOR: Final = 0.12  # misfit above which no rigid pulse is reported
    # Share of what the smooth pulse alone misses that must be left, or there is no ringing to be taken off
    BETTER: Final = 0.5


class OfTwoSensors:
    """Two sensors on one object."""

    # Share of a peak that a window goes on until both channels stay below: what is left moves no delay
    SETTLED: Final = 0.1
    CLEAR: Final = 4.0  # standard deviations of noise of the same: noise reaches it in one of 16 000 samples
    COPY: Final = 0.5  # share of energy that a delayed copy explains: half is a correlation of 0.7
    # Share of the largest correlation that another maximum must stay below, or the delay is ambiguous. Chosen
    RIVAL: Final = 0.9
    # Share of it that the correlation must fall to between both: noise on one maximum makes no second one
    APART: Final = 0.5
    SURE: Final = 0.1  # standard uncertainty of a gain of a trusted line. Chosen, as `OfTwoSensors.ALIKE`
    # Power over that of the noise in both channels that such a line has: noise then moves its gain by about a third
    ABOVE_NOISE: Final = 10.0
    # Standard uncertainty of the ratio of two sensitivities: shock calibrations state 3 to 5 % for a factor 2 (95 %)
    CALIBRATED: Final = 0.02
    ALIKE: Final = 0.1  # difference of the transfer function from 1 up to which two sensors move as one body
    TWICE: Final = 2.0  # standard uncertainties beyond which a difference is one (95 %)


class OfAnswers:
    """Thresholds for the kind of response after the blow of another channel."""

    BOTH_SIDES: Final = 0.5  # other side over the peak of a swing: a half-sine has 0, a sine at 5 % damping 0.85
    # Area over that of the magnitude that it then stays below: a half-sine has 1, that decaying sine less than 0.1
    ZERO_MEAN: Final = 0.2
    # Share of the largest value that its neighbours have in a round top: those of six samples a swing and more
    ROUND: Final = 0.5
    # Share of the peak magnitude down to which a free decay is followed: below, little is left of it beside the noise
    FREE: Final = 0.1
    CERTAIN: Final = 4.0  # standard uncertainties that the amplitude of a mode must have: noise alone gives one in 3000
    # Share of itself that a swing loses over the stretch, or it does not decay: hum, or what drives the structure on
    LOSES: Final = 0.1
    MOST_UNCERTAIN: Final = 0.1  # standard uncertainty of a frequency, over itself, beyond which it is none
