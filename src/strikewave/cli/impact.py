"""``strikewave impact``: one blow of two free bodies, in closed form."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strikewave.cli.common import Json, number, print_json, say, table
from strikewave.documents import head

if TYPE_CHECKING:
    from strikewave.contact import Stiffness

LARGEST_INDENTATION = 0.05
"""Share of the radius beyond which the indentation is warned of."""

_UNITS = {
    "restitution": "1",
    "asked_restitution": "1",
    "max_indentation": "m",
    "peak_force": "N",
    "duration": "s",
    "energy_lost": "J",
    "stiffness": "N/m^n",
    "exponent": "1",
    "hysteresis_factor": "1",
}


def command(
    m1: Annotated[str, typer.Option("--m1", help="Mass of the striker, such as 0.2 (kg) or inf.", show_default=False)],
    m2: Annotated[str, typer.Option("--m2", help="Mass of the object, such as '459 gram' or inf.", show_default=False)],
    speed: Annotated[str, typer.Option("--speed", help="Approach speed, such as 20 (m/s).", show_default=False)],
    restitution: Annotated[str, typer.Option("-e", "--restitution", help="Restitution asked for, above 0 to 1.")] = "1",
    damping: Annotated[str, typer.Option("--damping", help="Damping law: exact or li-ma-printed.")] = "exact",
    stiffness: Annotated[str | None, typer.Option("--stiffness", help="K in N/m^n.", show_default=False)] = None,
    exponent: Annotated[str | None, typer.Option("--exponent", help="n.", show_default=False)] = None,
    law: Annotated[
        str | None, typer.Option("--law", help="Stiffness law instead: palmgren or hertz.", show_default=False)
    ] = None,
    length: Annotated[
        str | None, typer.Option("--length", help="Contact length (palmgren).", show_default=False)
    ] = None,
    radius1: Annotated[
        str | None, typer.Option("--radius1", help="Radius of the striker (hertz).", show_default=False)
    ] = None,
    radius2: Annotated[str, typer.Option("--radius2", help="Radius of the object (hertz); inf is a plane.")] = "inf",
    material1: Annotated[str, typer.Option("--material1", help="Material of the striker.")] = "65Mn",
    material2: Annotated[str, typer.Option("--material2", help="Material of the object.")] = "65Mn",
    json: Json = False,
) -> int:
    """Solve the impact of two free bodies: F = K d^n (1 + chi d'/v0)."""
    from strikewave.contact import DAMPING_LAWS, Contact, factor, solve_impact
    from strikewave.errors import InputError, nearest

    if damping not in DAMPING_LAWS:
        raise InputError("--damping", damping, "a damping law", nearest(damping, DAMPING_LAWS))
    asked = _plain(restitution, "--restitution", 1e-6, 1.0)
    masses = [_quantity(m, "kg", f"--m{i}", infinite=True) for i, m in enumerate((m1, m2), start=1)]
    if all(math.isinf(mass) for mass in masses):
        raise InputError("--m2", m2, "at most one infinite mass")
    approach = _quantity(speed, "m/s", "--speed")
    given = _stiffness(stiffness, exponent, law, (length, radius1, radius2), (material1, material2))
    chi = float(factor(damping, asked))
    blow = solve_impact(Contact(given.stiffness, given.exponent, chi), masses[0], masses[1], approach)
    result: dict[str, Any] = {
        "restitution": float(blow.restitution),
        "asked_restitution": asked,
        "max_indentation": float(blow.max_indentation),
        "peak_force": float(blow.peak_force),
        "duration": float(blow.duration),
        "energy_lost": float(blow.energy_lost),
        "stiffness": given.stiffness,
        "exponent": given.exponent,
        "hysteresis_factor": chi,
        "law": given.law,
        "law_status": given.status,
        "damping": damping,
        "damping_status": DAMPING_LAWS[damping].status,
    }
    if not all(math.isfinite(value) for value in result.values() if isinstance(value, float)):
        raise InputError("impact", f"{m1}, {m2}, {speed}", "masses, speed and stiffness whose result is finite")
    warnings = []
    share = result["max_indentation"] / _quantity(radius1, "m", "--radius1") if law == "hertz" and radius1 else 0.0
    if share > LARGEST_INDENTATION:
        message = f"the indentation is {share:.0%} of the radius: Hertz's law holds for small indentations"
        warnings.append({"code": "indentation-large", "message": message, "value": share, "limit": LARGEST_INDENTATION})
    if abs(result["restitution"] - asked) > 1e-9:
        message = (
            f"the law {damping} gives e = {result['restitution']:.4f}, not the {asked:g} asked for; exact gives it"
        )
        warnings.append(
            {"code": "restitution-differs", "message": message, "value": result["restitution"], "limit": asked}
        )
    if json:
        print_json({**head(_UNITS, warnings), **result})
        return 0
    rows = [
        ("restitution", f"{result['restitution']:.6g}, {asked:g} asked for"),
        ("largest indentation", number(result["max_indentation"], "m", "um", 6) + " um"),
        ("peak force", number(result["peak_force"], "N", "N", 6) + " N"),
        ("duration", number(result["duration"], "s", "us", 6) + " us"),
        ("energy lost", number(result["energy_lost"], "J", "J", 6) + " J"),
        ("stiffness", f"{given.stiffness:.6g} N/m^{given.exponent:.4g} ({given.law}, {given.status})"),
        ("hysteresis factor", f"{chi:.6g} ({damping}, {result['damping_status']})"),
    ]
    table("Impact of two free bodies", ["", ""], rows)
    for warning in warnings:
        say(f"warning [{warning['code']}]: {warning['message']}")
    return 0


def _stiffness(
    stiffness: str | None,
    exponent: str | None,
    law: str | None,
    sizes: tuple[str | None, str | None, str],
    names: tuple[str, str],
) -> Stiffness:
    from strikewave.contact import STIFFNESS_LAWS, Stiffness, hertz, palmgren
    from strikewave.errors import MISSING, InputError, nearest
    from strikewave.materials import material

    if (stiffness is None) == (law is None):
        raise InputError(
            "--stiffness",
            stiffness or MISSING,
            "either --stiffness with --exponent, or --law",
            "give exactly one of them",
        )
    if stiffness is not None:
        if exponent is None:
            raise InputError(
                "--exponent",
                "nothing",
                "the exponent n that belongs to --stiffness",
                "a line contact has 1.1111, a sphere 1.5",
            )
        return Stiffness(_plain(stiffness, "--stiffness", 0.0, 1e30), _plain(exponent, "--exponent", 0.1, 10.0))
    if law not in STIFFNESS_LAWS:
        raise InputError("--law", law, "a stiffness law", nearest(str(law), STIFFNESS_LAWS))
    bodies = [material(name, f"--material{i}") for i, name in enumerate(names, start=1)]
    if law == "palmgren":
        if sizes[0] is None:
            raise InputError("--length", MISSING, "the contact length of the law palmgren", 'such as --length "40 mm"')
        return palmgren(bodies[0], bodies[1], _quantity(sizes[0], "m", "--length"))
    if sizes[1] is None:
        raise InputError("--radius1", MISSING, "the radius of the law hertz", 'such as --radius1 "10 mm"')
    return hertz(
        bodies[0],
        bodies[1],
        _quantity(sizes[1], "m", "--radius1"),
        _quantity(sizes[2], "m", "--radius2", infinite=True),
    )


def _quantity(text: str, si: str, field: str, infinite: bool = False) -> float:
    from strikewave.errors import InputError
    from strikewave.units import DIMENSIONS, parse_typed

    value = parse_typed(text, si, field)
    if not value > 0.0 or (math.isinf(value) and not infinite):
        raise InputError(field, text, f"{DIMENSIONS[si][0]} above zero" + (", or inf" if infinite else ""))
    return value


def _plain(text: str, field: str, low: float, high: float) -> float:
    from strikewave.errors import InputError

    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not low < value <= high:
        raise InputError(field, text, f"a number above {low:g} and at most {high:g}")
    return value
