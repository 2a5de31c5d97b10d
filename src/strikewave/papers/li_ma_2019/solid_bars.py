"""A solid bar in place of the frame, struck on its end by the same half-cylinder: where simple models must agree."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from strikewave.analyses.fem.build import build_model, solid_of, vector
from strikewave.analyses.fem.result import FemSolution
from strikewave.analyses.fem.run import run_model
from strikewave.cases.case import Case, document_of
from strikewave.cases.tables.fem import FramePart, HalfCylinder
from strikewave.contact import AnyContact, Chain, ChainContact, Geometry, contact_modulus, simulate, stiffness_of
from strikewave.fem.model import Model
from strikewave.fem.run import interval_means
from strikewave.fem.solids import AnySolid, Elastic
from strikewave.papers.li_ma_2019.bodies import SimpleAnswer, answer_of, edges_of, gathered, layer_of
from strikewave.papers.li_ma_2019.element_pulses import struck_body, whole_force
from strikewave.waves import Impactor, Sampled, Stack, Tap, run_bar

BAR, END = "bar", "far end"
"""Name of the part, and of the section whose acceleration is watched."""
FINE = 2.0
"""Elements of the contact in the Hertz half-width of the line, at the peak of the force: enough for the force, where
pressures take three."""
ZONE, GROWTH = 2.0, 1.3
"""Depth of the fine zone over that half-width, in which the stress below a Hertz line, p/sqrt(1 + (z/a)^2), falls to
0.45 of its pressure, and growth of elements beyond it (chosen)."""
ACROSS = 10.0
"""Coarse elements over the radius of the striker and the side of the bar: the wave of the blow is far longer."""
LASTING = 1.8
"""Duration of a run over the width of the force of two masses. Chosen: long enough that the blow, which ends later
on a bar, is over."""
INTERVAL = 0.5e-6
"""Interval of the histories, s: half of that which the paper writes."""
UNKNOWN_DURATION = 1e-3
"""Duration in which the blow of two masses is solved to find its width, s: five times the published width."""
WATCHED_ELEMENT = 0.1
"""Height of the watched section over the free end, in coarse elements: within the last one."""


@dataclass(frozen=True)
class BarBlow:
    """A half-cylinder that strikes the end of a square bar, all elastic; lengths in m, speed in m/s, times in s."""

    striker: AnySolid
    bar: AnySolid
    radius: float
    striker_length: float
    speed: float
    side: float
    length: float
    duration: float
    interval: float

    @property
    def striker_mass(self) -> float:
        """Mass of the striker, kg."""
        return 0.5 * math.pi * self.radius**2 * self.striker_length * self.striker.density

    @property
    def mass(self) -> float:
        """Mass of the bar, kg."""
        return self.bar.density * self.side**2 * self.length

    def contact(self, datum_depth: float) -> AnyContact:
        """Return the line contact by Johnson, with the bar's yielding down to a depth in it."""
        sizes = Geometry(radius1=self.radius, length=self.side, datum_depth=datum_depth)
        return stiffness_of("johnson", self.striker, self.bar, sizes).contact()


def elastic(model: Model) -> Model:
    """Return a model none of whose parts yields."""
    solids = {
        name: Elastic(solid.density, solid.youngs_modulus, solid.poissons_ratio) for name, solid in model.solids.items()
    }
    return replace(model, solids=solids)


def solid_bar(case: Case, length: float | None = None, interval: float = INTERVAL) -> BarBlow:
    """Return the blow of a frame's striker on a square bar of its solid, as thick as it is deep and as long as high.

    The striker is cut to the depth of the frame: what stands out beside a bar bears a part of the load there, which no
    line contact knows, and makes the force about 3 % higher.

    Parameters
    ----------
    case : Case
        With one half-cylinder and one frame.
    length : float, optional
        Length of the bar in place of the frame's height, m.
    interval : float, optional
        Sampling interval of the histories, s.

    Examples
    --------
    >>> from strikewave import load_case
    >>> blow = solid_bar(load_case("li-ma-2019-fem-rigid"))
    >>> round(blow.mass, 3), blow.length
    (0.465, 0.06)
    """
    parts = case.mesh.part if case.mesh else ()
    (striker,) = (part for part in parts if isinstance(part, HalfCylinder))
    (frame,) = (part for part in parts if isinstance(part, FramePart))
    blow = BarBlow(
        striker=solid_of(striker),
        bar=solid_of(frame),
        radius=striker.radius.si,
        striker_length=frame.depth.si,
        speed=vector(frame.velocity)[2] - vector(striker.velocity)[2],
        side=frame.depth.si,
        length=length or frame.height.si,
        duration=UNKNOWN_DURATION,
        interval=interval,
    )
    return replace(blow, duration=LASTING * bar_lumped(blow).width)


def bar_lumped(blow: BarBlow) -> SimpleAnswer:
    """Return the answer of two masses: all of the bar's yielding, over its whole length, is in the contact law."""
    chain = Chain(
        {"striker": blow.striker_mass, BAR: blow.mass}, [ChainContact("striker", BAR, blow.contact(blow.length))]
    )
    edges = edges_of(blow)
    motion = simulate(chain, {}, {"striker": blow.speed}, float(edges[-1]))
    speeds = motion.speeds(edges)[:, 1]
    return answer_of("lumped", edges, blow.mass * speeds, blow.mass, float(interval_means(speeds, edges).max()))


def bar_layered(blow: BarBlow) -> SimpleAnswer:
    """Return the answer of a bar as one layer, by delay lines.

    The contact law has the yielding of the bar down to half its side, where a load that spreads by 45 degrees fills it;
    what lies deeper is the layer's.
    """
    edges = edges_of(blow)
    stack = Stack((layer_of(BAR, blow.bar, blow.side**2, blow.length),))
    striker = Impactor(blow.striker_mass, blow.speed, blow.contact(0.5 * blow.side))
    run = run_bar(stack, striker, [Tap(0, 1.0)], float(edges[-1]))
    end = float(interval_means(np.interp(edges, run.time, run.velocity[:, 0]), edges).max())
    return answer_of("layered", edges, gathered(blow, run, run.face_force), blow.mass, end)


def bar_dispersed(blow: BarBlow) -> float:
    """Return the peak acceleration of the far end where short waves run slower, m/s^2.

    The layer is that of a round bar of the same area by Love and Rayleigh, under the force of `bar_layered`, by the
    spectral solver.
    """
    answer, edges = bar_layered(blow), edges_of(blow)
    layer = layer_of(BAR, blow.bar, blow.side**2, blow.length)
    slow = replace(layer, dispersion="love-rayleigh", poissons_ratio=blow.bar.poissons_ratio)
    load = Sampled(np.append(0.0, answer.time), np.append(0.0, answer.force))
    run = run_bar(Stack((slow,)), load, [Tap(0, 1.0)], float(edges[-1]))
    return float(interval_means(np.interp(edges, run.time, run.velocity[:, 0]), edges).max())


def bar_case(blow: BarBlow, case: Case) -> Case:
    """Return the case of a blow in finite elements, with solids, length and radius of the frame's case."""
    parts = document_of(case)["mesh"]["part"]
    (striker,) = (part for part in parts if part["shape"] == "half-cylinder")
    (frame,) = (part for part in parts if part["shape"] == "frame")
    fine = _half_width(blow)
    mesh = {"finest": _metres(fine / FINE), "extent": _metres(ZONE * fine), "growth": GROWTH, "sector": "quarter"}
    side = _metres(blow.side)
    bar = {"name": BAR, "shape": "block", "width": side, "depth": side, "height": _metres(blow.length)}
    own = {key: frame[key] for key in ("material", "solid") if key in frame}
    place = {"z": _metres(blow.length + blow.radius)}
    cuts = [f"{name}.{cut}" for name in (striker["name"], BAR) for cut in ("x-", "y-")]
    return Case.model_validate(
        {
            "schema": 1,
            "name": f"{case.name}-bar",
            "source": case.source,
            "mesh": {
                "part": [
                    striker
                    | mesh
                    | {"length": _metres(blow.striker_length), "at": place, "size": _metres(blow.radius / ACROSS)},
                    bar | own | mesh | {"size": _metres(blow.side / ACROSS)},
                ]
            },
            "fem": {
                "duration": f"{blow.duration!r} s",
                "interval": f"{blow.interval!r} s",
                "contact": [{"first": f"{BAR}.z+", "second": f"{striker['name']}.round"}],
                "boundary": [{"kind": "symmetry", "side": cut} for cut in cuts],
                "section": [
                    {
                        "name": END,
                        "part": BAR,
                        "point": {"z": _metres(WATCHED_ELEMENT * blow.side / ACROSS)},
                        "normal": "z",
                    }
                ],
            },
        }
    )


def element_answer(solution: FemSolution, watched: float | None) -> SimpleAnswer:
    """Return the answer of elements on the first contact of a model, of whole bodies; ``watched`` in m/s^2."""
    contact_force = whole_force(solution)
    if contact_force is None:
        raise ValueError(f"nothing touched in {solution.case.name}")
    _, force, _ = contact_force
    spans = np.diff(solution.run.time)
    body = struck_body(solution)
    mass = {**solution.parts, **solution.groups}[body].mass
    return answer_of("elements", solution.run.time, np.concatenate([[0.0], np.cumsum(force * spans)]), mass, watched)


def bar_elements(blow: BarBlow, case: Case, threads: int = 1) -> SimpleAnswer:
    """Return the answer of finite elements, elastic: a quarter, as fine at the contact as its width asks for."""
    struck_bar = bar_case(blow, case)
    solution = run_model(struck_bar, elastic(build_model(struck_bar, threads)))
    speeds = solution.run.sections[END].velocity[:, 2]
    return element_answer(solution, float(-interval_means(speeds, solution.run.time).min()))


def _half_width(blow: BarBlow) -> float:
    """Return the Hertz half-width of the line at the peak of the force, a^2 = 4 F R/(pi E* h) (Johnson 1985), m."""
    modulus = contact_modulus(blow.striker, blow.bar)
    return math.sqrt(4.0 * bar_lumped(blow).peak * blow.radius / (math.pi * modulus * blow.side))


def _metres(length: float) -> str:
    """Return a length as a case has it."""
    return f"{length!r} m"
