"""How much each threshold of the checks matters: planted records whose findings change where it is moved.

    python benchmarks/planted_thresholds.py [DRAWS]

Each is moved down by a fifth and up by a quarter, a count by one; a finding changes by its code or its severity. A
quarter of an hour for two draws of each class, the default. What comes out is said in the docstring of
`strikewave.records.thresholds`.
"""

import sys

import planted_boards
from planted import boards, classes

from strikewave.records import Channel, Record, Request, read_file, reading, thresholds
from strikewave.records.health import CHECKS
from strikewave.records.health_notice import OF_BOTH

FIRST = 4000
"""Seed of the first draw."""
OF = {
    "OfBeginning": "zero", "OfZero": "zero", "OfRange": "limits", "OfTops": "limits", "OfSwings": "limits",
    "OfSampling": "limits", "OfNoise": "disturbances", "OfRinging": "disturbances", "OfBlows": "blows", "OfResponses": "blows",
}  # fmt: skip
"""Module of the checks that a section of thresholds decides."""


def planted(draws):
    """Return planted records, measured, as the checks of their health take them."""
    records = []
    reading.examine = lambda record, *only: records.append(record) or []
    for kind in classes.CLASSES:
        for seed in range(FIRST, FIRST + (1 if kind.endswith(("files", "campaign")) else draws)):
            for draft in classes.draw(kind, seed).files[:2]:
                channel = Channel("a", draft.values, draft.setting.step, unit="m/s^2")
                read_file(Record("a.csv", "text", (channel,)), {}, Request())
    for kind in boards.CLASSES:
        for seed in range(FIRST, FIRST + draws):
            planted_boards.read(boards.draw(kind, seed))
    return records


def findings(records, module):
    """Return codes and severities of what the checks of a module find on each record."""
    own = [check for check in CHECKS if check.find.__module__.endswith(f"health.{module}")]
    found = []
    for record in records:
        record._made.clear()
        asked = [check for check in own if check.of in (record.kind, OF_BOTH)]
        found.append([(one.code, one.severity) for check in asked for one in check.notices(record)])
    return found


def moved(value):
    """Return a threshold moved down and up."""
    if isinstance(value, int):
        return max(value - 1, 1), value + 1
    return [tuple(f * v for v in value) if isinstance(value, tuple) else f * value for f in (0.8, 1.25)]


def main(draws):
    """Print a line a threshold."""
    records = planted(draws)
    print(f"{len(records)} records")
    for section, module in OF.items():
        numbers, before = getattr(thresholds, section), findings(records, module)
        for name, value in list(vars(numbers).items()):
            if name.startswith("_"):
                continue
            changed = []
            for other in moved(value):
                setattr(numbers, name, other)
                changed.append(sum(a != b for a, b in zip(before, findings(records, module), strict=True)))
            setattr(numbers, name, value)
            print(f"{section}.{name} = {value}: {changed[0]}, {changed[1]}", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 2)
