"""Files of LS-DYNA as LS-DYNA writes them, for tests: text by the formats of LSTC's own converter, d3plot by its manual.

Formats of ``rcforc`` and ``glstat``: ``translate_rcforc`` and ``translate_glstat`` of LSTC's ``l2a.c`` (distributed with
the LSDA sources and carried in public repositories), and two runs that are public: GitHub
praveenvenky110395/LS-DYNA-Crimping-Simulation, results/rcforc and results/glstat (``smp d R16``: SURFA, SURFB, moments,
contacts of one surface, "added mass"), and hu-shuhan/editOpeniGame, test/Format Validation Test/lsdyna/
Bolt_B_Explicit/glstat (``mpp.190 s``, steps set by solids). Only the layout is theirs; every number here is of the tests.
"""

import struct
from itertools import chain

import numpy as np

OLD, NEW = ("slave ", "master"), ("SURFA", "SURFB")
"""Words for the sides of a contact in older and newer versions."""


def rcforc(contacts, titles, time, style=NEW, moments=True):
    """``contacts``: number -> (outputs, 3); the other side bears the opposite. In the units of the file."""
    lines = [" A run of a test", "                    ls-dyna smp d R16 R16.1_180_d50332d date 07/09/2025", ""]
    if titles:
        lines += ["{BEGIN LEGEND}", " Entity #        Title"]
        lines += [f"{n:9d}     {title:70s}" for n, title in titles.items()]
        lines += ["{END LEGEND}", ""]
    for k, t in enumerate(time):
        for number, force in contacts.items():
            if force is None:
                lines += [f" interface number,{number:10d},is single surface-resultants are undefined"] * 2
                continue
            for word, sign in zip(style, (1.0, -1.0), strict=True):
                x, y, z = sign * force[k] + 0.0
                line = f"  {word}{number:{17 - len(word)}d} time{t:12.5E}  x {x:12.5E}  y {y:12.5E}  z {z:12.5E} mass{0.0:13.5E}"
                lines.append(line + (f"  mx {0.0:12.5E}  my {0.0:12.5E}  mz {0.0:12.5E}" if moments else ""))
    return "\n".join(lines) + "\n"


GLSTAT = (
    "kinetic energy.................", "internal energy................", "spring and damper energy.......",
    "hourglass energy ..............", "system damping energy..........", "sliding interface energy.......",
    "external work..................", "eroded kinetic energy..........", "total energy...................",
    "total energy / initial energy..", "energy ratio w/o eroded energy.", "global x velocity..............",
)  # fmt: skip


def glstat(time, energies, version="mpp.190 s"):
    """``energies``: name -> (outputs,), others are 0; in the units of the file."""
    lines = [" A run of a test", f"                         ls-dyna {version}              date 10/29/2021"]
    for k, t in enumerate(time):
        lines += ["", "", f" dt of cycle{k + 1:8d} is controlled by solid         100778 of part        10", ""]
        lines += [f" time...........................{t:14.5E}", f" time step......................{1e-9:14.5E}"]
        for label in GLSTAT:
            values = energies.get(label.rstrip(" ."))
            lines.append(f" {label}{0.0 if values is None else values[k]:14.5E}")
        lines += [" time per zone cycle.(nanosec)..             0", "", ""]
        lines += [" number of shell elements that  ", " reached the minimum time step..    0", "", ""]
        lines += [" added mass.....................   0.28468E-03", " percentage increase............   0.22936E+05"]
    return "\n".join(lines) + "\n"


def d3plot(path, points, hexahedra, part, numbers, titles, states, word=4, order="<", alone=True, history=0):
    """Write a d3plot of solids as "LS-DYNA Database Binary Output Files" (2017) has it.

    ``states``: rows of time, coordinates, velocity, stress, plastic strain, alive. ``alone``: states in the first file.
    """
    whole, real = np.dtype(f"{order}i{word}"), np.dtype(f"{order}f{word}")
    head = np.zeros(64, whole)
    head[11], head[15], head[16], head[17] = 1, 4, len(points), 6
    head[20], head[21], head[23], head[24] = 1, 1, len(hexahedra), len(numbers)
    head[27], head[34], head[36] = 7 + history, history, -10000
    head[39], head[43], head[44] = 16 + len(points) + len(hexahedra) + 3 * len(numbers), 1000, 1000
    head[51] = len(numbers)
    geometry = [head.tobytes(), points.astype(real).tobytes()]
    geometry.append(np.column_stack([hexahedra + 1, part + 1]).astype(whole).tobytes())
    numbering = [-1, 0, 0, 0, 0, len(points), len(hexahedra), 0, 0, 0, 0, 0, 0, len(numbers), 0, len(numbers)]
    ids = chain(
        numbering, range(1, len(points) + 1), range(1, len(hexahedra) + 1), numbers, numbers, range(1, len(numbers) + 1)
    )
    geometry.append(np.array(list(ids), whole).tobytes())
    end = np.array([-999999.0], real).tobytes()
    geometry += [end, np.array([90000], whole).tobytes(), b"A run of a test".ljust(72)]
    geometry.append(np.array([90001, len(numbers)], whole).tobytes())
    for number, title in zip(numbers, titles, strict=True):
        geometry.append(np.array([number], whole).tobytes() + title.encode().ljust(72))
    geometry.append(end)
    held = []
    for time, place, velocity, stress, strain, alive in states:
        solids = np.column_stack([stress, strain, *[np.full(len(stress), 77.0)] * history])
        words = [np.array([time]), place.ravel(), velocity.ravel(), solids.ravel(), alive.astype(float)]
        held.append(np.concatenate(words).astype(real).tobytes())
    if alone:
        path.write_bytes(_blocks(b"".join([*geometry, *held, end]), word))
        return
    path.write_bytes(_blocks(b"".join(geometry), word))
    for k, state in enumerate(held, 1):
        path.with_name(f"{path.name}{k:02d}").write_bytes(_blocks(state + end, word))


def _blocks(held, word):
    """Zeros up to a whole number of blocks of 512 words, as LS-DYNA fills its files."""
    return held + bytes(-len(held) % (512 * word))


def binout(records, order="<"):
    """An archive: (path, name, type, values) one after another, with the tables of contents that LSTC's library adds."""
    code = {1: "b", 3: "i", 9: "f", 10: "d"}
    held = bytearray([8, 8, 8, 1, 1, 1 if order == "<" else 0, 0, 0])
    held += struct.pack(f"{order}qBq", 17, 7, 0)
    for folder, name, kind, values in records:
        held += struct.pack(f"{order}qB", 9 + len(folder), 2) + folder.encode()
        numbers = struct.pack(f"{order}{len(values)}{code[kind]}", *values)
        held += struct.pack(f"{order}qBBB", 11 + len(name) + len(numbers), 3, kind, len(name)) + name.encode() + numbers
        held += struct.pack(f"{order}qB", 9 + 5, 5) + b"table"
    return bytes(held)
