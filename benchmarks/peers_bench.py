"""One impact of two free bodies by the peers, Exudyn and MuJoCo.

Each solves it by the contact it offers, asked for the same restitution, and with our force law given to it. Exudyn's
contact is told how fast it is struck: it learns that after a step, and bodies that touch at the start have none before.
MuJoCo's contact is a linear spring and damper that never pulls: the damping ratio gives the restitution, the stiffness
stores the same energy at the same depth. The largest force is that of a spline through the peer's steps, not timed.
"""

import contextlib
import math
import tempfile

import numpy as np
from peers import absent
from scipy.interpolate import CubicSpline
from timing import best, write

from strikewave.contact import Contact, exact, solve_impact
from strikewave.contact.damping import cut_off_damping_ratio

STIFFNESS, EXPONENT, RESTITUTION, M1, M2, SPEED = 4.7e9, 10 / 9, 0.5, 0.2, 0.459, 20.0
CHI = float(exact(RESTITUTION))
EXACT = solve_impact(Contact(STIFFNESS, EXPONENT, CHI), M1, M2, SPEED)
SPAN = 1.2 * float(EXACT.duration)


def misses(parting, peak):
    """Write how far a restitution and a largest force are off."""
    found = (parting / SPEED / RESTITUTION - 1, peak / float(EXACT.peak_force) - 1)
    return tuple(f"{abs(miss):.0e}" for miss in found)


def summit(times, forces):
    """Return the top of the spline through a peer's steps."""
    return CubicSpline(times, forces)(np.linspace(times[0], times[-1], 20_001)).max()


def timed(solving, building):
    """Write the time of a solve, and of the solve with the building before it."""
    return f"{write(solving)} ({write(solving + building)} with building)"


@contextlib.contextmanager
def quiet(exudyn):
    """Keep Exudyn from printing, and its files in a folder that goes away."""
    config = exudyn.config
    kept = config.printToConsole, config.outputDirectory
    with tempfile.TemporaryDirectory() as folder:
        config.printToConsole, config.outputDirectory = False, folder
        try:
            yield
        finally:
            config.printToConsole, config.outputDirectory = kept


def exudyn_law(power, most):
    """Return our force law as Exudyn's user function, in plain or in symbolic functions."""

    def force(mbs, t, item, gap, rate, stiffness, damping, offset):
        return -most(STIFFNESS * power(most(-gap, 0.0), EXPONENT) * (1.0 - CHI / SPEED * rate), 0.0)

    return force


def exudyn_system(contact):
    """Build the two bodies with ``python`` or ``symbolic`` for our law, or the number of Exudyn's impact model."""
    import exudyn.itemInterface
    from exudyn.advancedUtilities import CreateSymbolicUserFunction

    items = exudyn.itemInterface
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    markers = []
    for mass, speed in ((M1, SPEED), (M2, 0.0)):
        node = system.AddNode(
            items.Node1D(referenceCoordinates=[0.0], initialCoordinates=[0.0], initialVelocities=[speed])
        )
        system.AddObject(items.Mass1D(mass=mass, nodeNumber=node))
        markers.append(system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=0)))

    kept = None
    if contact == "python":
        law = exudyn_law(pow, max)
        system.AddObject(items.CoordinateSpringDamper(markerNumbers=markers, springForceUserFunction=law))
    elif contact == "symbolic":
        law, name = exudyn_law(exudyn.symbolic.pow, exudyn.symbolic.max), "springForceUserFunction"
        touch = system.AddObject(items.CoordinateSpringDamper(markerNumbers=markers))
        kept = CreateSymbolicUserFunction(system, law, name, touch)
        system.SetObjectParameter(touch, name, kept)
    else:
        memory = system.AddNode(items.NodeGenericData(initialCoordinates=[0.0, SPEED], numberOfDataCoordinates=2))
        system.AddObject(
            items.ObjectContactCoordinate(
                markerNumbers=markers,
                nodeNumber=memory,
                contactStiffness=STIFFNESS,
                contactStiffnessExponent=EXPONENT,
                restitutionCoefficient=RESTITUTION,
                impactModel=contact,
            )
        )
    sensor = system.AddSensor(
        items.SensorNode(nodeNumber=0, storeInternal=True, outputVariableType=exudyn.OutputVariableType.Coordinates_tt)
    )
    system.Assemble()
    return system, sensor, (container, kept)


def exudyn_settings(solver, step, tolerance=None):
    """Return settings with a fixed step, or at most that step at a tolerance; no files, no records."""
    import exudyn

    settings = exudyn.SimulationSettings()
    settings.solution.file.write = settings.solution.sensors.active = False
    settings.solution.sensors.writePeriod = 1e-12
    time = settings.timeIntegration
    time.solverType = getattr(exudyn.DynamicSolverType, solver)
    time.numberOfSteps = math.ceil(SPAN / step)
    time.endTime = time.numberOfSteps * step
    time.verboseMode = 0
    time.discontinuous.useRecommendedStepSize = False
    time.automaticStepSize = tolerance is not None
    if tolerance is not None:
        time.absoluteTolerance = time.relativeTolerance = tolerance
        time.initialStepSize = 1e-3 * SPAN
    return settings


def exudyn_row(how, contact, *numbers):
    """Return the row of one contact of Exudyn with one solver."""
    system, sensor, _kept = exudyn_system(contact)
    settings = exudyn_settings(*numbers)
    building = best(lambda: exudyn_system(contact))
    solving = best(lambda: system.SolveDynamic(settings), 20)
    speeds = system.systemData.GetODE2Coordinates_t()
    settings.solution.sensors.active = True
    system.SolveDynamic(settings)
    record = system.GetSensorStoredData(sensor)
    peak = summit(record[:, 0], -M1 * record[:, 1])
    return (f"Exudyn, {how}", timed(solving, building), *misses(speeds[1] - speeds[0], peak))


def exudyn_rows():
    """Return the rows of Exudyn."""
    if absent("exudyn"):
        return [("Exudyn", absent("exudyn"), "-", "-")]
    import exudyn

    cases = (
        ("its Hunt-Crossley contact, DOPRI5 at 1e-8", 1, "DOPRI5", 2e-6, 1e-8),
        ("its Gonthier / Carvalho-Martins contact, DOPRI5 at 1e-8", 2, "DOPRI5", 2e-6, 1e-8),
        ("our law in Python, RK4, 1 us", "python", "RK44", 1e-6),
        ("our law symbolic, RK4, 1 us", "symbolic", "RK44", 1e-6),
        ("our law symbolic, RK4, 3 us", "symbolic", "RK44", 3e-6),
        ("our law symbolic, DOPRI5 at 1e-8", "symbolic", "DOPRI5", 2e-6, 1e-8),
    )
    with quiet(exudyn):
        return [exudyn_row(*case) for case in cases]


def force_law(state):
    """Return our force at the state of the two bodies in MuJoCo."""
    (x1, x2), (v1, v2) = state.qpos.tolist(), state.qvel.tolist()
    return max(STIFFNESS * max(x1 - x2, 0.0) ** EXPONENT * (1.0 + CHI * (v1 - v2) / SPEED), 0.0)


def mujoco_model(step, integrator, soft):
    """Build the two bodies on one axis, just touching, with MuJoCo's contact or without."""
    import mujoco

    reduced = M1 * M2 / (M1 + M2)
    depth = ((EXPONENT + 1) * reduced * SPEED**2 / (2 * STIFFNESS)) ** (1 / (EXPONENT + 1))
    square = 2 * STIFFNESS / (EXPONENT + 1) * depth ** (EXPONENT - 1) / reduced
    damping = 2 * cut_off_damping_ratio(RESTITUTION) * math.sqrt(square)
    contact = f'condim="1" solref="{-square} {-damping}" solimp=".9999 .9999 .001"'
    bodies = "".join(
        f'<body pos="{place} 0 0"><joint type="slide" axis="1 0 0"/>'
        f'<geom type="sphere" size=".02" mass="{mass}" {contact}/></body>'
        for place, mass in ((0.0, M1), (0.04, M2))
    )
    flag = "enable" if soft else "disable"
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{step}" integrator="{integrator}" gravity="0 0 0"><flag contact="{flag}"/></option>'
        f"<worldbody>{bodies}</worldbody></mujoco>"
    )
    return model, mujoco.MjData(model)


def mujoco_soft(model, state, count):
    """Step through the impact with MuJoCo's own contact."""
    import mujoco

    mujoco.mj_step(model, state, count)


def mujoco_applied(model, state, count):
    """Step through the impact with our force applied before each step."""
    import mujoco

    for _ in range(count):
        force = force_law(state)
        state.qfrc_applied[:] = -force, force
        mujoco.mj_step(model, state)


def mujoco_called(model, state, count):
    """Step through the impact with our force in a callback, at each stage of a step."""
    import mujoco

    def push(_, now):
        force = force_law(now)
        now.qfrc_passive[0] -= force
        now.qfrc_passive[1] += force

    mujoco.set_mjcb_passive(push)
    try:
        mujoco.mj_step(model, state, count)
    finally:
        mujoco.set_mjcb_passive(None)


def mujoco_row(how, advance, step, integrator):
    """Return the row of one way through the impact in MuJoCo."""
    import mujoco

    soft, count = advance is mujoco_soft, math.ceil(SPAN / step)
    model, state = mujoco_model(step, integrator, soft)

    def start():
        mujoco.mj_resetData(model, state)
        state.qvel[0] = SPEED

    def solve():
        start()
        advance(model, state, count)

    building, solving = best(lambda: mujoco_model(step, integrator, soft)), best(solve, 20)
    parting = state.qvel[1] - state.qvel[0]
    forces = []
    start()
    for _ in range(count):
        law = force_law(state)
        advance(model, state, 1)
        forces.append(-state.qfrc_constraint[0] if soft else law)
    peak = summit(step * np.arange(count), np.array(forces))
    return (f"MuJoCo, {how}", timed(solving, building), *misses(parting, peak))


def mujoco_rows():
    """Return the rows of MuJoCo."""
    if absent("mujoco"):
        return [("MuJoCo", absent("mujoco"), "-", "-")]
    cases = (
        ("its soft contact, Euler, 1 us", mujoco_soft, 1e-6, "Euler"),
        ("its soft contact, Euler, 10 ns", mujoco_soft, 1e-8, "Euler"),
        ("our law applied at each step, Euler, 1 us", mujoco_applied, 1e-6, "Euler"),
        ("our law applied at each step, Euler, 0.3 us", mujoco_applied, 3e-7, "Euler"),
        ("our law in a callback, RK4, 1 us", mujoco_called, 1e-6, "RK4"),
    )
    return [mujoco_row(*case) for case in cases]


def rows():
    """Return the rows of the table: how, time, miss of the restitution, miss of the largest force."""
    return exudyn_rows() + mujoco_rows()


if __name__ == "__main__":
    for row in rows():
        print(" | ".join(row))
