"""From what a file holds to even samples in SI: sensitivity, gain, polarity, unit, time stamps, missing samples.

    value = polarity x count x file value / (gain x sensitivity x excitation / rated excitation)

Each factor is left out where it is not given. All are texts with units, kept as they were typed, so that a result
can state what made it.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from strikewave.base.documents import read_toml
from strikewave.base.errors import InputError, nearest
from strikewave.base.texts import percent
from strikewave.base.units import convertible, parse_quantity, split_number, typed_number
from strikewave.records.health_notice import FIGURES, HealthNotice
from strikewave.records.record import Array, Channel
from strikewave.records.thresholds import OfClock

MEASURED = ("m/s^2", "m/s", "m", "N", "Pa", "1")  # SI units that a channel can have once calibrated; 1 is strain
# The file that calibrates all records of its folder; FILE.toml calibrates FILE alone and goes first
FOLDER_FILE = "calibration.toml"
LARGEST_FILE = 100_000  # bytes of a calibration file: a few lines for each of hundreds of channels
LONGEST_UNIT = 80  # characters of a unit that are looked at
# Units that some write for multiples of standard gravity, and that are masses; how to write what is then meant
_AMBIGUOUS = {"kg": "1000 g", "mg": "0.001 g", "ug": "1e-6 g", "µg": "1e-6 g"}
# Units as instruments and loggers write them, and as `strikewave.base.units` does
_SPELLINGS = {
    "G": "g", "gs": "g", "g's": "g", "gn": "g", "g_n": "g", "grav": "g",
    "volt": "V", "volts": "V", "v": "V", "millivolts": "mV",
    "m/s2": "m/s^2", "m/s²": "m/s^2", "m/sec^2": "m/s^2", "m/s/s": "m/s^2",
    "me": "ustrain", "ue": "ustrain", "µe": "ustrain", "με": "ustrain", "µε": "ustrain", "microstrain": "ustrain",
    "ε": "strain", "ϵ": "strain",
}  # fmt: skip


class Scale(NamedTuple):
    """The number that turns file values into an SI unit; the unit is empty where the unit of the file is not known."""

    factor: float
    unit: str


@dataclass(frozen=True)
class ChannelCalibration:
    """Conversion of the values of a channel to SI.

    Attributes
    ----------
    unit : str
        Unit of the file's values, such as ``g`` or ``mV``; overrules that of the file.
    sensitivity : str
        Output per quantity, such as ``1.2 mV/g``, ``-4 pC/N``, ``0.2 uV/V/g``.
    gain : str
        Gain of the amplifier: a number, or ``10 mV/pC`` of a charge amplifier.
    excitation, rated_excitation : str
        Voltage of the bridge in the test, and that at which the sensitivity holds.
    count : str
        Voltage of one count of the converter, such as ``305.2 uV``.
    polarity : int
        1, or -1 for a sensor mounted the other way.
    """

    unit: str = ""
    sensitivity: str = ""
    gain: str = ""
    excitation: str = ""
    rated_excitation: str = ""
    count: str = ""
    polarity: int = 1

    def scale(self, file_unit: str = "", field: str = "calibration") -> Scale:
        """Return the factor to SI and its unit.

        Examples
        --------
        >>> ChannelCalibration(sensitivity="2 mV/N", gain="10").scale("V")
        Scale(factor=50.0, unit='N')
        """
        if self.polarity not in (1, -1) or isinstance(self.polarity, bool):
            raise InputError(f"{field}.polarity", self.polarity, "1 or -1")
        unit = self.unit or file_unit
        if not self.sensitivity:
            spare = [name for name in ("gain", "excitation", "rated_excitation", "count") if getattr(self, name)]
            if spare:
                raise InputError(f"{field}.{spare[0]}", getattr(self, spare[0]), "nothing without a sensitivity")
            if self.unit:
                check_unit(unit, f"{field}.unit")
            known = known_unit(unit)
            return Scale(float(self.polarity), "") if known is None else Scale(self.polarity * known[1], known[0])
        output, per, measured = _sensitivity(self.sensitivity, f"{field}.sensitivity")
        volts = _voltage(self.count, f"{field}.count") if self.count else _volts(unit, field)
        per *= self._excited(output, field) * self._gain(output, field)
        factor = self.polarity * volts / per if per else math.inf
        if not math.isfinite(factor) or factor == 0.0:
            raise InputError(f"{field}.sensitivity", self.sensitivity, "factors that are not zero")
        return Scale(factor, measured)

    def _excited(self, output: str, field: str) -> float:
        volts = _voltage(self.excitation, f"{field}.excitation") if self.excitation else 0.0
        if output == "V/V":
            if not volts:
                hint = "the sensitivity is per volt of it"
                raise InputError(f"{field}.excitation", self.excitation, "a voltage", hint)
            return volts
        if bool(self.excitation) != bool(self.rated_excitation):
            missing = "rated_excitation" if self.excitation else "excitation"
            raise InputError(f"{field}.{missing}", "", "a voltage", "excitation and rated_excitation go together")
        return volts / _voltage(self.rated_excitation, f"{field}.rated_excitation") if volts else 1.0

    def _gain(self, output: str, field: str) -> float:
        if output == "C":
            if not self.gain:
                raise InputError(f"{field}.gain", "", "a gain in mV/pC", "the sensitivity is a charge")
            quantity = _number_and_unit(self.gain, f"{field}.gain", ("V/C",))
            return quantity[0] * quantity[2]
        try:
            gain = float(self.gain or 1.0)
        except ValueError:
            gain = math.nan
        if not (math.isfinite(gain) and gain != 0.0):
            raise InputError(f"{field}.gain", self.gain, "a number that is not zero")
        return gain

    def stated(self) -> dict[str, Any]:
        """Return what is stated, as typed."""
        return {k: v for k, v in dataclasses.asdict(self).items() if v not in ("", 1)}


def known_unit(text: str) -> tuple[str, float] | None:
    """Return the SI unit of a unit as files write it, and the factor to it; None for an unknown one."""
    plain = text.strip().strip("[]()").strip()
    number, unit = split_number(plain[:LONGEST_UNIT]) or (0.0, "")
    if unit and number > 0.0:  # a unit with a number before it, such as 1000 g
        known = known_unit(unit)
        return None if known is None or not math.isfinite(number) else (known[0], number * known[1])
    return convertible(_SPELLINGS.get(plain, _SPELLINGS.get(plain.lower(), plain)), (*MEASURED, "V"))


def check_unit(unit: str, field: str) -> None:
    """Refuse a unit that is stated and not known."""
    if known_unit(unit) is None:
        allowed = 'a unit, or a number with a unit such as "1000 g", of ' + ", ".join(MEASURED[:-1])
        hint = ambiguous(unit) or nearest(unit, ("g", "m/s^2", "mV", "V", "kN", "N", "MPa", "Pa", "ustrain", "mm"))
        raise InputError(field, unit, f"{allowed}, strain or V", hint)


def check_part(name: str, text: str, field: str) -> None:
    """Refuse a part of a calibration, named as in `ChannelCalibration`, that can be none."""
    if name == "unit":
        check_unit(text, field)
    elif name == "sensitivity":
        _sensitivity(text, field)
    elif name == "gain" and not typed_number(text):  # zero is no gain either
        try:
            _number_and_unit(text, field, ("V/C",))
        except InputError:
            allowed = 'a number that is not zero, or that of a charge amplifier, such as "10 mV/pC"'
            raise InputError(field, text, allowed) from None
    elif name in ("excitation", "rated_excitation", "count"):
        _voltage(text, field)


def ambiguous(unit: str) -> str:
    """Return what to write instead of a unit that some write for a multiple of gravity, such as one of mass.

    Examples
    --------
    >>> ambiguous("kg"), ambiguous("g")
    ('kg is a mass; for thousands of g: --unit "1000 g"', '')
    >>> ambiguous("kilo-g")
    'thousands of g are --unit "1000 g"'
    """
    plain = unit.strip().strip("[]()").strip()
    if re.fullmatch(r"k(ilo)?[- ]?(g|gee|gn)'?s?", plain.lower()) and plain.lower() != "kg":
        return 'thousands of g are --unit "1000 g"'
    meant = _AMBIGUOUS.get(plain, _AMBIGUOUS.get(plain.lower(), ""))
    of = {"1000 g": "thousands", "0.001 g": "thousandths"}.get(meant, "millionths")
    return f'{plain} is a mass; for {of} of g: --unit "{meant}"' if meant else ""


def calibrated(
    channel: Channel, calibration: ChannelCalibration, field: str = "calibration"
) -> tuple[Channel, list[HealthNotice]]:
    """Return a channel in SI; its unit stays empty where the unit of the file is not known."""
    scale = calibration.scale(channel.unit, field)
    findings = _overruled(calibration.unit, channel.unit)
    if not scale.unit:
        reason = f"{channel.unit} is no unit known here" if channel.unit else "the file names no unit"
        stated = ambiguous(channel.unit) or f"{reason}; state it, such as --unit g"
        message = f"{stated}; figures are in the file's own numbers"
        findings.append(HealthNotice("unit-unknown", message, severity="good"))
    elif scale.unit == "V":
        message = 'volts; state the sensor, such as --sensitivity "1.2 mV/g"; figures are in V'
        findings.append(HealthNotice("not-calibrated", message, severity="good"))
    with np.errstate(over="ignore"):
        values = channel.values if scale.factor == 1.0 else channel.values * scale.factor
    return dataclasses.replace(channel, values=values, unit=scale.unit), findings


def _overruled(stated: str, of_file: str) -> list[HealthNotice]:
    """Tell that a unit that is stated is not that of the file, where the file has one that is known."""
    known = known_unit(of_file) if stated and of_file else None
    if known is None or known == known_unit(stated):
        return []
    message = f"the unit that is stated, {stated}, overrules that of the file, {of_file}"
    return [HealthNotice("unit-overrules", message, severity="good")]


def _voltage(text: str, field: str) -> float:
    value = parse_quantity(text, "V", field)
    if not value > 0.0:
        raise InputError(field, text, "a voltage above zero")
    return value


def _volts(unit: str, field: str) -> float:
    """Return the volts that one of the file's numbers stands for; volts where the file has no unit."""
    known = known_unit(unit) if unit else ("V", 1.0)
    if known is None or known[0] != "V":
        hint = "a sensitivity is for a file in volts: leave out one of both; for counts give count"
        raise InputError(f"{field}.unit", unit, "V or mV", hint)
    return known[1]


def _number_and_unit(text: str, field: str, choices: tuple[str, ...]) -> tuple[float, str, float]:
    number, rest = split_number(text) or (math.nan, "")
    unit = re.sub(r"/\s*\(([^()/]*)/([^()/]*)\)", r"/\1*\2", rest.replace("²", "^2"))
    si = convertible(unit, choices) if unit else None
    if si is None or not math.isfinite(number) or number == 0.0:
        example = "10 mV/pC" if choices == ("V/C",) else "1.2 mV/g"
        hint = "" if choices == ("V/C",) else "V or C (or V/V) per g, N, Pa, m/s, m or strain"
        allowed = f'a number that is not zero and its unit, such as "{example}"'
        raise InputError(field, text, allowed, hint)
    return number, *si


def _sensitivity(text: str, field: str) -> tuple[str, float, str]:
    """Return output (V, C or V/V), its SI value per SI quantity, and the SI unit of the quantity."""
    per = {"m/s^2": "s^2/m", "m/s": "s/m", "m": "1/m", "N": "1/N", "Pa": "1/Pa"}
    choices = {
        f"{output}*{inverse}".replace("*1/", "/"): (output, si) for output in "VC" for si, inverse in per.items()
    }
    choices |= {inverse: ("V/V", si) for si, inverse in per.items()}
    slashes = text.count("/")
    choices |= {"V": ("V", "1"), "C": ("C", "1")} if slashes else {}
    choices |= {"1": ("V/V", "1")} if slashes > 1 else {}
    number, si, factor = _number_and_unit(text, field, tuple(choices))
    output, measured = choices[si]
    return output, number * factor, measured


def calibrations_beside(path: str | Path) -> dict[str, dict[str, Any]]:
    """Return what the small files beside a record state: a table a channel, ``all`` for all of them."""
    path = Path(path)
    files = (path.with_name(FOLDER_FILE), path.with_name(path.name + ".toml"))
    return laid_over(*(read_calibrations(file) for file in files if file.is_file()))


def laid_over(*layers: Mapping[str, Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """Lay tables over each other, channel by channel; a later ``all`` goes over an earlier channel."""
    merged: dict[str, dict[str, Any]] = {}
    for layer in layers:
        for key in merged:
            merged[key] |= layer.get("all", {})
        for key, table in layer.items():
            merged[key] = {**merged.pop(key, {}), **table}
    return merged


def read_calibrations(file: Path) -> dict[str, dict[str, Any]]:
    """Read a calibration file: ``schema = 1``, then ``[all]`` and ``[channel.NAME]`` tables."""
    try:
        if file.stat().st_size > LARGEST_FILE:
            raise InputError(str(file), f"{file.stat().st_size} bytes", f"at most {LARGEST_FILE} bytes")
        data = read_toml(file.read_text("utf-8-sig"))
    except InputError:
        raise
    except (OSError, ValueError) as error:
        raise InputError(str(file), str(error)[:60], "a calibration in TOML") from None
    schema = data.pop("schema", 1)
    if schema != 1 or isinstance(schema, bool):
        raise InputError(f"{file}: schema", schema, "1")
    for extra in sorted(set(data) - {"all", "channel"}):
        hint = nearest(extra, ("all", "channel"))
        raise InputError(f"{file}: {extra}", "unknown", "tables [all] and [channel.NAME]", hint)
    channels = data.get("channel", {})
    tables = {"all": data["all"]} if "all" in data else {}
    if isinstance(channels, Mapping) and "all" in channels:
        raise InputError(f"{file}: channel.all", "all", "the name or number of a channel", "[all] is for all of them")
    if not isinstance(channels, Mapping):
        raise InputError(f"{file}: channel", channels, "tables [channel.NAME]")
    return {name: _checked(table, f"{file}: {name}") for name, table in (tables | dict(channels)).items()}


def _checked(table: Any, field: str) -> dict[str, Any]:
    known = {f.name: f.type for f in dataclasses.fields(ChannelCalibration)}
    if not isinstance(table, Mapping):
        raise InputError(field, table, "a table")
    for key, value in table.items():
        if key not in known:
            raise InputError(f"{field}.{key}", "unknown", "a part of a calibration", nearest(key, known))
        numeric = key == "gain" and isinstance(value, int | float) and not isinstance(value, bool)
        if key != "polarity" and not numeric and not isinstance(value, str):
            raise InputError(f"{field}.{key}", value, 'a text with its unit, such as "1.2 mV/g"')
    return {key: str(value) if key == "gain" else value for key, value in table.items()}


def calibration_of(stated: Mapping[str, Mapping[str, Any]], name: str, number: int) -> ChannelCalibration:
    """Return the calibration of a channel: its own table, by name or by number, over the one for all.

    Where both its name and its number stand, the later goes over the earlier.
    """
    merged = dict(stated.get("all", {}))
    for key, table in stated.items():
        if key in (str(number), name):
            merged |= table
    return ChannelCalibration(**merged)


SENSELESS = 1e30  # no time, and no sample, is as large: instruments write such numbers for none (9.9e37)
# Grid samples for each one recorded: bounds the memory of stamps that jump by years
BRIDGED, BRIDGED_AT_LEAST = 4, 1000
WITHIN_DIGIT = 1.001  # times the last digit that rounded stamps may stray by: floating point adds its own
# The last digit is looked for in the last tenth of the stamps, the largest ones, and in 50 at least
LAST_TENTH, FEWEST_STAMPS = 10, 50
# Digits of a stamp that are tried: fewer would not tell a step, and more a double does not hold
FEWEST_DIGITS, MOST_DIGITS = 3, 15
# Share of a digit by which a stamp may differ from a whole number of them: of 14 digits, a double keeps so much
WHOLE = 1e-4
TINIEST = 1e-200  # times below which there is no digit to find, s


def even(channel: Channel) -> tuple[Channel, list[HealthNotice]]:
    """Return a channel with uniform sampling and without missing samples, and what had to be mended.

    Examples
    --------
    >>> stamps = np.array([0.0, 1.0, 2.0, 3.0, 5.0, 6.0])
    >>> mended, findings = even(Channel("a", np.array([0.0, 1.0, np.nan, 3.0, 5.0, 6.0]), 1.0, stamps=stamps))
    >>> mended.values.tolist(), [finding.code for finding in findings]
    ([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0], ['gap', 'not-a-number'])
    """
    if channel.stamps is None and not channel.step > 0.0:
        hint = 'such as --rate "200 kHz"; or name the column that holds time with --time'
        raise InputError("--rate", f"nothing for {channel.name}", "a sampling rate: the file gives no time", hint)
    findings: list[HealthNotice] = []
    if channel.stamps is not None:
        channel, findings = _resampled(channel, channel.stamps)
    channel, missing = _filled(channel)
    return channel, findings + missing


def _resampled(channel: Channel, stamps: Array) -> tuple[Channel, list[HealthNotice]]:
    findings = []
    here = np.abs(stamps) < SENSELESS
    if not here.all():
        share = 1.0 - float(here.mean())
        message = f"{percent(share, 2)} of the time stamps are no times; their samples are left out"
        findings.append(HealthNotice("time-missing", message, share))
    values, stamps = channel.values[here], stamps[here]
    steps = np.diff(stamps)
    rounded = _rounded(stamps, steps)
    if rounded is not None:
        start, step = rounded
        return dataclasses.replace(channel, values=values, step=step, start=start, stamps=None), findings
    back = int(np.count_nonzero(steps < 0.0))
    same = int(np.count_nonzero(steps == 0.0))
    if back:
        where = float(stamps[int(np.argmax(steps < 0.0))])
        times = "once" if back == 1 else f"{back} times"
        message = f"time runs backwards {times}, first after {where:g}\xa0s: are these several records in one file?"
        findings.append(HealthNotice("time-backwards", message, back, severity="bad", harms=FIGURES, start=where))
    if back or same:
        order = np.argsort(stamps, kind="stable")
        stamps, first = np.unique(stamps[order], return_index=True)
        values = values[order][first]
        if same:
            message = f"{same} time stamps stand twice; the first sample of each is kept"
            mixed = same >= OfClock.MOST_TWICE * values.size
            if mixed:
                message += ": most do, so that samples of several channels may stand in one column"
            harms = FIGURES if mixed else ()
            findings.append(HealthNotice("time-twice", message, same, "bad" if mixed else "suspect", harms))
        steps = np.diff(stamps)
    if stamps.size < 2:
        return dataclasses.replace(channel, values=values, stamps=None), findings
    usual = float(np.median(steps))
    near = steps[np.abs(steps - usual) <= OfClock.USUAL * usual]
    step = float(np.mean(near)) if near.size else usual
    grid_size = round(float(stamps[-1] - stamps[0]) / step) + 1
    bridged = grid_size <= BRIDGED * stamps.size + BRIDGED_AT_LEAST
    rounding = _last_digit(stamps) if _share_odd(steps, usual) > OfClock.ROUNDED_STEPS else 0.0
    findings += _gaps(stamps, steps, (step, rounding), bridged)
    stray = 0.0
    if grid_size == stamps.size:
        stray = float(np.max(np.abs(stamps - stamps[0] - step * np.arange(stamps.size))))
    if bridged and (grid_size != stamps.size or stray > OfClock.UNEVEN * step + rounding):
        if not any(f.code == "gap" for f in findings):
            message = f"time stamps stray by up to {percent(stray / step)} of a step; the record is resampled uniformly"
            severity = "suspect" if stray > OfClock.JITTER * step else "good"
            findings.append(HealthNotice("time-uneven", message, stray, severity, ("spectrum",)))
        grid = stamps[0] + step * np.arange(grid_size)
        values = np.interp(grid, stamps, values)
    return dataclasses.replace(channel, values=values, step=step, start=float(stamps[0]), stamps=None), findings


def _rounded(stamps: Array, steps: Array) -> tuple[float, float] | None:
    """Return start and step of time stamps that are even but for their last digit; None for others.

    Rounding may make neighbours equal. One lost sample strays as little; but then all other steps are the same.
    """
    if steps.size < 2 or not stamps[-1] > stamps[0] or float(np.min(steps)) < 0.0:
        return None
    places = np.arange(stamps.size) - 0.5 * steps.size
    middle = float(np.mean(stamps))
    step = float(np.sum(places * (stamps - middle)) / np.sum(places**2))  # np.dot would wait for threads of BLAS
    stray = float(np.max(np.abs(stamps - middle - step * places)))
    if float(np.min(steps)) == 0.0 and step >= (1.0 - OfClock.UNEVEN) * _last_digit(stamps):
        return None  # digits as fine as the step never make neighbours equal: the lines are those of several channels
    if _share_odd(steps, float(np.median(steps))) <= OfClock.ODD_STEPS or stray > WITHIN_DIGIT * _last_digit(stamps):
        return None
    return middle - 0.5 * step * steps.size, step


def _share_odd(steps: Array, usual: float) -> float:
    """Return the share of steps that are not the usual one."""
    return float(np.mean(np.abs(steps - usual) > OfClock.UNEVEN * usual))


def _last_digit(stamps: Array) -> float:
    """Return the worth of the last digit of the largest time stamps, as they were rounded when written, s."""
    part = np.abs(stamps[-max(stamps.size // LAST_TENTH, FEWEST_STAMPS) :])
    largest = float(np.max(part))
    if largest < TINIEST:
        return 0.0
    decade = math.floor(math.log10(largest))
    part = part[part >= 10.0**decade]
    for digits in range(FEWEST_DIGITS, MOST_DIGITS):
        unit = 10.0 ** (decade - digits + 1)
        if np.all(np.abs(part / unit - np.round(part / unit)) < WHOLE):
            return max(unit, float(np.spacing(largest)))
    return float(np.spacing(largest))


def _gaps(stamps: Array, steps: Array, clock: tuple[float, float], bridged: bool) -> list[HealthNotice]:
    step, rounding = clock
    wide = np.flatnonzero(steps > OfClock.GAP * step + rounding)
    if not wide.size:
        return []
    lost = float(np.sum(steps[wide])) - step * wide.size
    share = lost / float(stamps[-1] - stamps[0])
    longest = int(wide[np.argmax(steps[wide])])
    message = (
        f"{wide.size} gap{'s' if wide.size > 1 else ''} in time, {percent(share, 2)} of the record, the longest "
        f"{steps[longest]:.3g}\xa0s after {stamps[longest]:g}\xa0s; "
        + ("bridged by straight lines" if bridged else "too long to be bridged")
    )
    begin, end = (float(stamp) for stamp in stamps[longest : longest + 2])
    return [HealthNotice("gap", message, lost, *_harm_of_lost(share), begin, end)]


def _filled(channel: Channel) -> tuple[Channel, list[HealthNotice]]:
    values = channel.values
    missing = ~(np.abs(values) < SENSELESS)
    count = int(np.count_nonzero(missing))
    if not count:
        return channel, []
    first = channel.start + channel.step * int(np.argmax(missing))
    if count == values.size:
        message = "no sample is a number"
        return channel, [HealthNotice("not-a-number", message, count, severity="bad", harms=FIGURES)]
    places = np.arange(values.size)
    filled = values.copy()
    filled[missing] = np.interp(places[missing], places[~missing], values[~missing])
    share = count / values.size
    message = (
        f"{count} samples ({percent(share, 2)}) are no finite numbers, the first at {first:g}\xa0s; "
        "bridged by straight lines"
    )
    return dataclasses.replace(channel, values=filled), [
        HealthNotice("not-a-number", message, count, *_harm_of_lost(share), first)
    ]


def _harm_of_lost(share: float) -> tuple[str, tuple[str, ...]]:
    """Return severity and harmed figures where straight lines stand in place of a share of the samples."""
    return ("bad", FIGURES) if share > OfClock.MOST_LOST else ("suspect", ("spectrum",))
