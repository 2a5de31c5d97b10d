"""Layout of a machine's state, modes, memory and switch functions.

Three systems share one order of things: the whole machine (strikers, nose and assembly as bodies), the machine in
free flight in a fast run (the object is one body, the strikers ride on their circles), and the strikers alone, beside a
stack of layers. What a system has none of is an empty part.

- bodies: strikers, nose, assembly; in free flight nose and assembly are one body;
- bases: a seat for each striker that is a body, then the carriage;
- links: contacts, mounts, frame, then what holds the object: support, stop, and a rail where one rubs;
- state: positions and speeds of the bodies, turntable angle and speed, belt twist and motor speed, then energies:
  dissipated in each link, given by the drive, lost in drag and belt, given by the feed, lost by noses that slide;
- modes: of the links, of drive and feed, passes counted, whether this pass has touched, the striker (from 1) that met
  the edge of the face, whether each striker is before the face, and in free flight which striker touches (-1: none);
- memory: approach speed of each link, begin of the feed's phase, angle of the next apex, then how deep each link has
  yielded, and how much its radius has grown by that;
- switch functions: of the links, then the machine's own: where the drive reaches its torque, where it lets go, the end
  of the feed's phase, an apex, in free flight the first touch of each striker, then each at an edge of the face.

Who owns what: ``contact`` owns the chain (`strikewave.contact._chain_kernels.ChainTables`): bodies, links and their
laws, and of each of the four arrays what belongs to them. It finds its parts by their order alone: positions, speeds,
modes, approach speeds and switches of the links come first, depths and growths last, and it names where dissipated
powers go. ``machines`` owns the rest: the bases (seats on the turntable, carriage), turntable and drive, feed,
passes, and the edges of the face; it opens a contact that slips off. ``waves`` owns a stack of layers during a blow.

One thing has an index, a part of many a slice: ``y[at.speeds][i]`` is the speed of body i. Nobody else adds
offsets. Python and kernels call the same functions.
"""

from typing import Any, NamedTuple

from numba.extending import register_jitable

from strikewave.base.compiled import LEAF
from strikewave.contact._chain_kernels import SWITCHES

FULL_TORQUE_SWITCH, NO_TORQUE_SWITCH, FEED_SWITCH, APEX_SWITCH = 0, 1, 2, 3
"""Places of drive, feed and apex among the machine's own switch functions: the same in every system."""
_DRIVE_FEED_APEX = 4
"""Number of these switch functions."""
STRIKER, OBJECT = 0, 0
"""Numbers of the bodies of a fast run: of the one striker in a blow, and of the object in free flight."""


class StateLayout(NamedTuple):
    """Places of everything in one system; see the module.

    Bodies and links have their numbers in the chain (``carriage`` among the bases). Then come places in the state
    (``positions`` to ``held_energies``), the modes (``link_modes`` to ``held_modes``), the memory (``approaches`` to
    ``growths``) and the switch functions (``touches`` and ``edges`` among the machine's own), each followed by how many
    there are.
    """

    strikers: slice
    object: slice
    nose: int
    assembly: int
    carriage: int
    contacts: slice
    mounts: slice
    frame: int
    support: int
    stop: int
    rail: int
    rubs: bool  # whether there is a rail
    positions: slice
    speeds: slice
    turntable: slice
    angle: int
    turntable_speed: int
    belt_twist: int
    motor_speed: int
    dissipated: slice
    of_drive: slice
    driven: int
    dragged: int
    fed: int
    rubbed: int
    energies: slice
    held_energies: slice  # of the links from the support on, and of the drive
    states: int
    link_modes: slice
    own_modes: slice
    drive: int
    feed: int
    passes: int
    touched: int
    edge: int
    on_face: slice
    touching: int
    held_modes: slice
    modes: int
    approaches: slice
    own_memory: slice
    feed_start: int
    next_apex: int
    depths: slice
    growths: slice
    memories: int
    link_switches: slice
    own_switches: slice
    touches: slice
    edges: slice
    switches: int


@register_jitable(**LEAF)
def layout(bodies: int, links: int, seats: int, strikers: int) -> StateLayout:
    """Return the layout of a system of so many bodies, links, seats that are bases, and strikers."""
    mounted = strikers - seats
    full = 1 if bodies - seats == 2 else 0  # nose and assembly are two bodies in the whole machine alone
    contacts, mounts = full * seats, (full + 1) * seats
    support = mounts + full
    angle = 2 * bodies
    dissipated = angle + 4
    of_drive = dissipated + links
    states = of_drive + 4
    on_face = links + 5
    touching = on_face + strikers
    modes = touching + min(mounted, 1)
    depths = links + 2
    growths = depths + links
    own = SWITCHES * links
    touches = _DRIVE_FEED_APEX
    edges = touches + mounted
    switches = own + edges + strikers
    return StateLayout(
        strikers=slice(0, seats),
        object=slice(seats, bodies),
        nose=seats,
        assembly=bodies - 1,
        carriage=seats,
        contacts=slice(0, contacts),
        mounts=slice(contacts, mounts),
        frame=mounts,
        support=support,
        stop=support + 1,
        rail=support + 2,
        rubs=links > support + 2,
        positions=slice(0, bodies),
        speeds=slice(bodies, angle),
        turntable=slice(angle, dissipated),
        angle=angle,
        turntable_speed=angle + 1,
        belt_twist=angle + 2,
        motor_speed=angle + 3,
        dissipated=slice(dissipated, of_drive),
        of_drive=slice(of_drive, states),
        driven=of_drive,
        dragged=of_drive + 1,
        fed=of_drive + 2,
        rubbed=of_drive + 3,
        energies=slice(dissipated, states),
        held_energies=slice(dissipated + support, states),
        states=states,
        link_modes=slice(0, links),
        own_modes=slice(links, modes),
        drive=links,
        feed=links + 1,
        passes=links + 2,
        touched=links + 3,
        edge=links + 4,
        on_face=slice(on_face, touching),
        touching=touching,
        held_modes=slice(support, on_face),
        modes=modes,
        approaches=slice(0, links),
        own_memory=slice(links, depths),
        feed_start=links,
        next_apex=links + 1,
        depths=slice(depths, growths),
        growths=slice(growths, growths + links),
        memories=growths + links,
        link_switches=slice(0, own),
        own_switches=slice(own, switches),
        touches=slice(touches, edges),
        edges=slice(edges, edges + strikers),
        switches=switches,
    )


@register_jitable(**LEAF)
def layout_of(system: Any) -> StateLayout:
    """Return the layout of a system of tables: its chain, and a row of its seats for each striker."""
    chain = system.chain
    return layout(chain.bodies.shape[0], chain.joins.shape[0], chain.bases.shape[1] - 1, system.seats.shape[0])
