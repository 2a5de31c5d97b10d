"""``strikewave identify``: stiffness, exponent, restitution, mass and speed from a measured blow."""

from __future__ import annotations

import math
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from strikewave.reporting import measured_files as measured
from strikewave.reporting.terminal import Force, Json, Out, number, print_json, say, significant, table

if TYPE_CHECKING:
    from strikewave.contact.identification import Estimate, Identified
    from strikewave.records import ChannelReading, Options

NOT_DESCRIBED = 3
"""Exit code where the law does not describe the pulse."""
_UNITS = {
    "stiffness": "N/m^n",
    "exponent": "1",
    "restitution": "1",
    "mass": "kg",
    "speed": "m/s",
    "begin": "s",
    "momentum": "N s",
    "impulse": "N s",
    "peak_force": "N",
    "duration": "s",
    "stiffness_speed": "N/s^n",
    "noise": "N",
    "offset": "N",
    "residual": "1",
    "time": "s",
    "measured": "N",
    "fitted": "N",
}
_SHOWN = {"begin": "us", "duration": "us"}
_CALLED = {
    "mass": "reduced mass",
    "speed": "approach speed",
    "momentum": "mass x speed",
    "peak_force": "peak force",
    "stiffness_speed": "stiffness x speed^n",
    "begin": "first touch",
}


class Result(NamedTuple):
    """What a channel of a file tells of a contact."""

    file: str
    reading: ChannelReading
    found: Identified


def command(
    file: Annotated[
        str,
        typer.Argument(
            metavar="FILE",
            help="A measured file of any known format: force, or acceleration of one body.",
            show_default=False,
        ),
    ],
    mass: Annotated[
        str | None, typer.Option("--mass", help='Reduced mass, such as "0.14 kg".', show_default=False)
    ] = None,
    m1: Annotated[
        str | None, typer.Option("--m1", help="Mass of the striker, such as 0.2 (kg) or inf.", show_default=False)
    ] = None,
    m2: Annotated[
        str | None,
        typer.Option(
            "--m2", help='Mass of the struck body, such as "459 gram"; needed for an acceleration.', show_default=False
        ),
    ] = None,
    speed: Annotated[
        str | None, typer.Option("--speed", help="Approach speed, such as 20 (m/s).", show_default=False)
    ] = None,
    stiffness: Annotated[str | None, typer.Option("--stiffness", help="K in N/m^n.", show_default=False)] = None,
    exponent: Annotated[str | None, typer.Option("-n", "--exponent", help="n, 0.2 to 8.", show_default=False)] = None,
    restitution: Annotated[
        str | None, typer.Option("-e", "--restitution", help="e, 0.001 to 1.", show_default=False)
    ] = None,
    first: Annotated[
        str | None, typer.Option("--from", help="Fit from this time on, in the file's time.", show_default=False)
    ] = None,
    last: Annotated[str | None, typer.Option("--to", help="Fit up to this time.", show_default=False)] = None,
    channel: measured.Channels = None,
    unit: measured.Unit = None,
    sensitivity: measured.Sensitivity = None,
    gain: measured.Gain = None,
    excitation: measured.Excitation = None,
    rated_excitation: measured.RatedExcitation = None,
    count: measured.Count = None,
    polarity: measured.Polarity = None,
    rate: measured.Rate = None,
    time: measured.Time = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Find which contact F = K d^n (1 + chi d'/v0) of two free bodies makes the largest blow of a record.

    What is known (masses, speed, stiffness, n, e) is given; the rest is told with its standard error, or it is said
    why it cannot be. Exit code 3 where the law does not describe the blow.
    """
    stated = measured.stated_of(
        unit=unit, sensitivity=sensitivity, gain=gain, excitation=excitation,
        rated_excitation=rated_excitation, count=count, polarity=polarity,
    )  # fmt: skip
    known = _known({"--speed": speed, "--stiffness": stiffness, "--exponent": exponent, "--restitution": restitution})
    masses = {"--mass": mass, "--m1": m1, "--m2": m2}
    struck = None if m2 is None else _mass(m2, "--m2")
    reading = _reading(file, stated, measured.options_of(rate, time, channel))
    scale = _newtons(reading, struck)
    reduced = _reduced(masses, reading.channel.unit == "m/s^2")
    if reduced is not None:
        known["mass"] = reduced
    result = Result(file, reading, _identified(file, reading, scale, known, (first, last)))
    if out is not None:
        _write(result, out, force)
    if json:
        print_json(_document(result), indent=None)
    else:
        _print(result)
    return 0 if result.found.described else NOT_DESCRIBED


def _known(typed: dict[str, str | None]) -> dict[str, float]:
    """Return what is known, but for the masses."""
    from strikewave.base.errors import InputError
    from strikewave.contact.pulse_fit import EXPONENTS, RESTITUTIONS

    known = {}
    limits = {"--stiffness": (0.0, 1e300), "--exponent": EXPONENTS, "--restitution": RESTITUTIONS}
    for option, text in typed.items():
        if text is None:
            continue
        if option == "--speed":
            known["speed"] = measured.positive(text, "m/s", option)
            continue
        low, high = limits[option]
        value = float(text) if measured.is_bare(text) else math.nan
        if not (low <= value <= high and value > 0.0):
            allowed = (
                "a number above zero, in N/m^n" if option == "--stiffness" else f"a number from {low:g} to {high:g}"
            )
            raise InputError(option, text, allowed)
        known[option[2:]] = value
    return known


def _mass(text: str, option: str) -> float:
    from strikewave.base.errors import InputError
    from strikewave.base.units import parse_typed

    value = parse_typed(text, "kg", option)
    if not value > 0.0:
        raise InputError(option, text, "a mass above zero, or inf")
    return value


def _reduced(masses: dict[str, str | None], acceleration: bool) -> float | None:
    """Return the reduced mass where it is known; the mass of the struck body alone may be for its acceleration."""
    from strikewave.base.errors import MISSING, InputError
    from strikewave.contact.impact import reduced_mass

    typed = {option: text for option, text in masses.items() if text is not None}
    if "--mass" in typed:
        if "--m1" in typed or ("--m2" in typed and not acceleration):
            other = "--m1" if "--m1" in typed else "--m2"
            raise InputError(
                "--mass", typed["--mass"], f"--mass or {other}", "--mass is the reduced mass of both bodies"
            )
        return measured.positive(typed["--mass"], "kg", "--mass")
    if not typed or (typed.keys() == {"--m2"} and acceleration):
        return None
    missing = {"--m1", "--m2"} - typed.keys()
    if missing:
        raise InputError(missing.pop(), MISSING, "the mass of the other body, or inf", "or give the reduced --mass")
    striker, struck = (_mass(typed[option], option) for option in ("--m1", "--m2"))
    if math.isinf(striker) and math.isinf(struck):
        raise InputError("--m2", typed["--m2"], "at most one infinite mass")
    return float(reduced_mass(striker, struck))


def _reading(file: str, stated: dict[str, dict[str, Any]], options: Options) -> ChannelReading:
    """Return one channel of a file, examined; a bad one is named, and used all the same."""
    from strikewave.records import Request, calibrations_beside, read_file, read_record

    record = read_record(file, options)
    measured.check_channels(stated, [record])
    reading = read_file(record, calibrations_beside(Path(file)), Request(options.channels or ("1",), stated))
    for finding in reading.all_findings:
        if finding.severity != "good" and "peak" in finding.harms:
            say(f"{finding.severity} [{finding.code}]: {finding.message}")
    if len(reading.channels) > 1 or (not options.channels and len(record.channels) > 1):
        say(f"the blow is that of {reading.channels[0].channel.name}; --channel takes another")
    return reading.channels[0]


def _newtons(reading: ChannelReading, struck: float | None) -> float:
    """Return the newtons in one SI unit of a channel: 1 of a force, the struck mass of its acceleration."""
    from strikewave.base.errors import MISSING, InputError

    unit, name = reading.channel.unit, reading.channel.name
    if unit == "N":
        return 1.0
    if unit != "m/s^2":
        allowed = f"a force such as N, or an acceleration such as g, of {name}"
        raise InputError("--unit", unit or MISSING, allowed, "a voltage needs --sensitivity")
    if struck is None:
        hint = f'{name} is an acceleration: such as --m2 "0.459 kg"'
        raise InputError("--m2", MISSING, "the mass of the struck body, that makes a force of its acceleration", hint)
    if math.isinf(struck):
        raise InputError("--m2", "inf", f"a finite mass of the struck body, whose acceleration {name} is")
    return struck


def _identified(
    file: str, reading: ChannelReading, scale: float, known: dict[str, float], typed: tuple[str | None, str | None]
) -> Identified:
    from strikewave.base.errors import InputError
    from strikewave.base.units import parse_typed
    from strikewave.contact.identification import identify

    channel, window = reading.channel, None
    if typed != (None, None):
        first = -math.inf if typed[0] is None else parse_typed(typed[0], "s", "--from")
        last = math.inf if typed[1] is None else parse_typed(typed[1], "s", "--to")
        if not first < last:
            raise InputError("--to", typed[1], f"a time after --from, {first:g} s")
        window = (first, last)
    try:
        return identify(channel.time, scale * channel.values, known, window=window)
    except InputError:
        raise
    except ValueError as error:
        ways = {"negative": " (--polarity -1)", "window": " (--from, --to)"}
        how = next((way for word, way in ways.items() if word in str(error)), "")
        raise InputError("FILE", file, "a record of one whole blow", f"{error}{how}") from None


def _document(result: Result) -> dict[str, Any]:
    from strikewave.base.json_document import head, plain

    reading, found = result.reading, result.found
    document = {
        **head(_UNITS, _warnings(result)),
        "file": result.file,
        "channel": reading.channel.name,
        "measured_unit": reading.channel.unit,
        "status": reading.status,
        "calibration": reading.calibration.stated(),
        "values": {name: _row(estimate) for name, estimate in found.values.items()},
        "begin": _row(found.begin),
        "combinations": {name: _row(estimate) for name, estimate in found.combinations.items()},
        "correlation": {"names": found.names, "matrix": found.correlation},
        "noise": found.noise,
        "offset": found.offset,
        "residual": found.residual,
        "described": found.described,
        "words": found.words,
        "time": found.time,
        "measured": found.measured,
        "fitted": found.fitted,
    }
    return dict(plain(document))


def _row(estimate: Estimate) -> dict[str, Any]:
    return {"value": estimate.value, "standard_error": estimate.standard_error, "given": estimate.given}


def _warnings(result: Result) -> list[dict[str, Any]]:
    from strikewave.contact.identification import DESCRIBED

    found = result.found
    warnings = [
        {"code": f.code, "message": f.message, "value": f.value if f.value == f.value else None, "limit": None}
        for f in result.reading.findings
        if f.severity != "good" and "peak" in f.harms
    ]
    if not found.described:
        words = found.words[-1]
        warnings.append({"code": "law-misfit", "message": words, "value": found.residual, "limit": DESCRIBED})
    return warnings


def _write(result: Result, folder: Path, force: bool) -> None:
    import json

    from strikewave.analyses.impact.figures.identified import identified_figure
    from strikewave.base.output_folder import whole_folder
    from strikewave.reporting.style import plain, save

    path = Path(result.file)
    text = measured.identity(shlex.join(["strikewave", *sys.argv[1:]]), measured.digests_of([path]))
    figure = identified_figure(result.found)
    figure.suptitle(plain(f"{path.name}, {result.reading.channel.name}", 90), x=0.01, ha="left", fontsize=11)
    document = json.dumps(_document(result), allow_nan=False, ensure_ascii=False)
    with whole_folder(folder, text, force) as place:
        (place / "record.toml").write_text(text, "utf-8")
        (place / "identify.json").write_text(document + "\n", "utf-8")
        save(figure, place / "summary.svg")
    say(f"written: {folder}/ (summary.svg, identify.json, record.toml)")


def _print(result: Result) -> None:
    found = result.found
    rows = [_line(name, estimate) for name, estimate in found.values.items()]
    rows += [_line(name, estimate) for name, estimate in found.combinations.items()]
    rows.append(_line("begin", found.begin))
    title = f"Contact of {Path(result.file).name}, {result.reading.channel.name}: F = K d^n (1 + chi d'/v0)"
    table(title, ["", "value", "standard error", "unit"], rows)
    say(f"noise {significant(found.noise, 3)} N, misfit {found.residual:.2%} of the peak, {found.time.size} samples")
    shared = found.correlated("exponent", "restitution")
    if shared is not None:
        say(f"correlation of exponent and restitution: {shared:.2f}")
    for words in found.words[: None if found.described else -1]:
        say(words)
    for warning in _warnings(result):
        say(f"warning [{warning['code']}]: {warning['message']}")


def _line(name: str, estimate: Estimate) -> tuple[str, str, str, str]:
    unit = _UNITS[name]
    shown = _SHOWN.get(name, unit)
    called = _CALLED.get(name, name)
    if estimate.value is None:
        return called, "not told", "-", unit
    value = number(estimate.value, unit, shown, 5) if shown != unit else significant(estimate.value, 5)
    if estimate.standard_error is None:
        return called, value, "given", shown
    error = estimate.standard_error
    return called, value, number(error, unit, shown, 2) if shown != unit else significant(error, 2), shown
