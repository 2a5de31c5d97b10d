"""``strikewave impact``: blows of two free bodies, in closed form where the law allows it."""

from __future__ import annotations

from strikewave.analyses.impact import options as options
from strikewave.reporting.terminal import Force, Json, Out


def command(
    m1: options.M1,
    m2: options.M2,
    speed: options.Speed,
    restitution: options.Restitution = None,
    damping: options.Damping = None,
    damper: options.DamperName = None,
    time: options.DamperTime = None,
    stiffness: options.K = None,
    exponent: options.Exponent = None,
    law: options.LawName = None,
    length: options.Length = None,
    radius1: options.Radius1 = None,
    radius2: options.Radius2 = "inf",
    datum_depth: options.DatumDepth = None,
    material1: options.Material1 = "65Mn",
    material2: options.Material2 = "65Mn",
    yield_pressure: options.YieldPressure = None,
    yield_load: options.YieldLoad = None,
    shape: options.Shape = None,
    repeat: options.Repeat = "1",
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Solve the impact of two free bodies: F = K d^n (1 + chi d'/v0), or with a damper, or on a spot that yields."""
    from strikewave.analyses.impact.screen import solve_setup
    from strikewave.reporting.run_and_write import Output

    sizes = (length, radius1, radius2, datum_depth)
    loss = options.LossOptions(restitution, damping, damper, time)
    masses, approach = options.read_bodies(m1, m2, speed)
    base = options.read_base(options.StiffnessOptions(stiffness, exponent, law, *sizes, (material1, material2)))
    lost = options.read_loss(loss, base.stiffness, masses)
    cap = options.read_cap(options.YieldOptions(yield_pressure, yield_load, shape), base, damper)
    setup = options.Setup(masses, approach, base, lost, cap, options.read_repeat(repeat))
    return solve_setup(setup, Output(out, force, json))
