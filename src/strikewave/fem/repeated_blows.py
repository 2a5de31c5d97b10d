"""One blow after another: what the material remembers at the end of one is where the next begins; SI.

Between two blows of a machine lie many milliseconds. In that time

1. what drives and presses the bodies is gone, what strikes is away, and vibration dies out
   (`strikewave.fem.dynamic_relaxation`); contacts of parts that have the same velocity in the case stay closed;
2. each body goes back to where it began, as one rigid body and only along what boundaries leave it
   (`strikewave.fem.bodies`); one with a rigid part so that this stands exactly there;
3. where bodies touch that were moved, they come to rest once more.

Then all get the velocities of the model, time and curves begin at 0, and the energy balance with what residual
stresses hold. Plastic strain, back stress, temperature, shape and residual stress are kept. What would stand deeper in
what it strikes than before the first blow begins so much farther away, against its velocity; any other overlap is let
out without a force, as before a first blow (`strikewave.fem.contact`).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np

from strikewave.fem.bodies import Body, bodies_of, way_back
from strikewave.fem.dynamic_relaxation import settle
from strikewave.fem.engine import Engine
from strikewave.fem.mesh import TINY, Array
from strikewave.fem.model import Driven, Model, NonReflecting, Pressure, stays
from strikewave.fem.restart import put_back, state_of
from strikewave.fem.run import Rest

REST = 1e-10
"""Share of the energy in play of a blow that may be left as kinetic energy before the next.

Bodies that stay elastic then give the same peak and impulse within 1e-6; the difference falls as the root of the share.
It takes one to three times the steps of a blow."""
LONGEST = 20
"""Times the steps of a blow that its bodies may take to rest: several times the usual one to three."""
STEPS_BACK = 30
"""Steps back of what strikes at most; what is left then is let out without a force, and reported as an overlap.

Few do on surfaces that are convex; each step of a round one in a dent finds another nearest face."""
CLEAR = 1.01
"""Times the overlap by which it steps back: 1 would leave what rounding and the slope of a surface leave."""
ROUNDING = 1e-9
"""Share of the size of a mesh below which an overlap is rounding."""
LOADS = Driven | Pressure | NonReflecting
"""Boundaries that hold nothing at rest; dashpots would push a vibrating body away."""
State = Mapping[str, np.ndarray]


def next_blow(engine: Engine, energy: float, share: float = REST) -> Engine:
    """Return an engine that begins the next blow on what one that has ended left.

    Parameters
    ----------
    engine : Engine
        At the end of its run.
    energy : float
        In play in that run, J.
    share : float
        Of it that may be left as kinetic energy.
    """
    model, bodies = engine.model, bodies_of_engine(engine)
    quiet_model, wanted, ended = quiet(model), share * energy, state_of(engine)
    resting = Engine(quiet_model, engine.pool)
    put_back(resting, {**state_of(resting), **_left_of(ended, resting)})
    resting.initialize()
    begun = _plastic(resting)
    most = LONGEST * engine.steps
    settled = [settle(resting, bodies, wanted, most)]
    _bring_back(resting, bodies)
    if quiet_model.contacts or quiet_model.walls:
        moved = Engine(quiet_model, engine.pool)
        _take_over(moved, resting, meet=True)
        settled.append(settle(moved, bodies, wanted, most))
        resting = moved
    following = engine.begun_anew()
    first = _depths(following)
    _take_over(following, resting, meet=False)
    following.blow = engine.blow + 1
    added_distance = _step_back(following, bodies, first)
    following.rest = Rest(
        maxima=sum(each.maxima for each in settled),
        steps=sum(each.steps for each in settled),
        kinetic_share=max(each.kinetic for each in settled) / max(energy, TINY),
        plastic_energy=_plastic(resting) - begun,
        added_distance=added_distance,
        overlap=max(_depths(following).values(), default=0.0),
        plastic_before=_plastic(resting) + (engine.rest.plastic_before if engine.rest else 0.0),
    )
    following.overlaps = []
    for elements in following.solid.kinds:
        elements.begin_balance()
    following.initialize()
    return following


def bodies_of_engine(engine: Engine) -> list[Body]:
    """Return the bodies of a run, with the motions that all but driven sides leave them."""
    still = [hold for hold in engine.holds if hold.speed is None]
    return bodies_of(engine.model.mesh, engine.own_mass, engine.ties, still, engine.bodies)


def quiet(model: Model) -> Model:
    """Return a model between two blows: no velocity, load or dashpot, no contact of what was thrown at each other."""
    return dataclasses.replace(
        model,
        velocity={},
        gravity=(0.0, 0.0, 0.0),
        boundaries=tuple(each for each in model.boundaries if not isinstance(each, LOADS)),
        contacts=tuple(each for each in model.contacts if stays(model, (each.first, each.second))),
        walls=tuple(each for each in model.walls if stays(model, (each.side,))),
        sections=(),
        points=(),
    )


def _left_of(ended: State, engine: Engine) -> dict[str, np.ndarray]:
    """Return what the state at the end of a run leaves to bodies that come to rest in place."""
    places = {name for name in ended if name.startswith(("elements/", "contact/", "wall/"))}
    known = state_of(engine)
    left = {name: ended[name] for name in (places | set(_placed(ended)) | {"x"}) if name in known}
    return left | {"v": np.zeros_like(ended["v"])}


def _placed(state: State) -> State:
    """Return where the rigid parts of a state stand."""
    return {n: value for n, value in state.items() if n.startswith("body/") and n.endswith(("/centre", "/turned"))}


def _take_over(engine: Engine, other: Engine, meet: bool) -> None:
    """Give an engine that has not begun the shape and the elements of another."""
    state = state_of(other)
    left = {name: value for name, value in state.items() if name.startswith("elements/")}
    put_back(engine, {**state_of(engine), **left, **_placed(state), "x": other.x})
    engine.detect_contacts(engine.x)
    if meet:
        engine.initialize()


def _bring_back(engine: Engine, bodies: Sequence[Body]) -> None:
    """Move each body back to where it began, its stress with it."""
    mesh = engine.model.mesh
    turns = np.broadcast_to(np.eye(3), (engine.elements, 3, 3)).copy()
    for body in bodies:
        turn, shift = way_back(body, mesh.points, engine.x)
        _move(engine, body, turn, shift)
        turns[np.isin(mesh.hexahedra[:, 0], body.nodes)] = turn
    for elements in engine.solid.kinds:
        elements.turn(turns)


def _move(engine: Engine, body: Body, turn: Array, shift: Array) -> None:
    """Move a body by R x + t."""
    engine.x[body.nodes] = engine.x[body.nodes] @ turn.T + shift
    for rigid in engine.bodies:
        if rigid.nodes[0] in body.nodes:
            rigid.centre, rigid.turned = turn @ rigid.centre + shift, turn @ rigid.turned


def _step_back(engine: Engine, bodies: Sequence[Body], first: Mapping[str, float]) -> float:
    """Move what strikes back, against its velocity, until it is nowhere deeper in another than at first; return m."""
    moved = 0.0
    for _ in range(STEPS_BACK):
        before = moved
        for name, sides in engine.model.touching.items():
            moved += _clear(engine, bodies, sides, _depths(engine).get(name, 0.0) - first.get(name, 0.0))
        if moved == before:
            break
    return moved


def _clear(engine: Engine, bodies: Sequence[Body], sides: Sequence[str], deep: float) -> float:
    """Move what strikes on two sides back by what it stands too deep; return m."""
    model = engine.model
    if deep <= ROUNDING * float(np.ptp(model.mesh.points, axis=0).max()) or stays(model, sides):
        return 0.0
    body = max((b for b in bodies if _in(b, sides)), key=lambda b: _speed(model, b))
    velocity = max((np.array(model.velocity.get(part, np.zeros(3))) for part in body.parts), key=np.linalg.norm)
    back = -CLEAR * deep / np.linalg.norm(velocity) * velocity
    _move(engine, body, np.eye(3), back)
    engine.detect_contacts(engine.x)
    return float(np.linalg.norm(back))


def _in(body: Body, sides: Sequence[str]) -> bool:
    return any((side.rpartition(".")[0] or side) in body.parts for side in sides)


def _speed(model: Model, body: Body) -> float:
    return max(float(np.linalg.norm(model.velocity.get(part, (0.0, 0.0, 0.0)))) for part in body.parts)


def _depths(engine: Engine) -> dict[str, float]:
    """Return the deepest overlap of each contact and wall that has one, m."""
    return {each.contact: each.deepest for each in engine.overlaps}


def _plastic(engine: Engine) -> float:
    return float(engine.solid.work()[1])
