"""A sensor by itself: an accelerometer of the table by name, or the [[sensor]] of a file."""

from __future__ import annotations

import math
from pathlib import Path
from typing import NamedTuple

from strikewave.base.citations import FROM_MEMORY
from strikewave.base.errors import MISSING, InputError, nearest, show
from strikewave.base.result import INFO, Notice
from strikewave.cases.paths import Form
from strikewave.cases.sensors_of_case import chain_of, memory_notices
from strikewave.cases.small_file import read_small_file
from strikewave.cases.tables.base import CaseTable
from strikewave.cases.tables.sensor import SensorTable
from strikewave.sensors import Accelerometer, Recorder, Sensor, accelerometer, accelerometers


class SensorFile(CaseTable):
    """What such a file holds: the [[sensor]] of a case, as ``buffer --record`` writes it."""

    sensor: tuple[SensorTable, ...]


FORM = Form(SensorFile, "sensor", 'sensor.shock.range="20000 g"')
ALLOWED = 'a TOML file with one [[sensor]], such as name = "shock" and model = "Endevco 2225"'


class StatedSensor(NamedTuple):
    """A sensor with its recorder, and where its numbers come from.

    Attributes
    ----------
    sensor, recorder : Sensor, Recorder
        What reads, and what keeps it.
    model : Accelerometer or None
        The row of the table that its numbers are from, as far as they are not its own.
    notices : tuple of Notice
        Numbers from memory.
    """

    sensor: Sensor
    recorder: Recorder
    model: Accelerometer | None
    notices: tuple[Notice, ...]


def stated_sensor(asked: str, field: str) -> StatedSensor:
    """Return the accelerometer of a name, directly mounted, or the sensor of a file that ends in ``.toml``.

    Raises
    ------
    InputError
        If the table has no such accelerometer, or the file cannot be used.

    Examples
    --------
    >>> stated_sensor("endevco 2225", "--sensor").sensor.resonance
    80000.0
    """
    if asked.lower().endswith(".toml"):
        return _of_table(_only_table(Path(asked), field), field)
    known = {name.lower(): row for name, row in accelerometers().items()}
    model = known.get(asked.lower())
    if model is None:
        hint = nearest(asked, accelerometers())
        listed = "" if hint.startswith("choose") else f" ({', '.join(accelerometers())})"
        raise InputError(field, asked, f"an accelerometer of the table{listed}, or a file that ends in .toml", hint)
    message = f"range and resonance of {model.name} are from memory: no data sheet that states them could be opened; "
    message += "give them in a file with [[sensor]] from yours"
    said = (Notice("sensor-from-memory", message, 1.0, 0.0, INFO),) if model.status == FROM_MEMORY else ()
    return StatedSensor(model.mounted(), Recorder(), model, said)


def _of_table(table: SensorTable, field: str) -> StatedSensor:
    if table.tap:
        raise InputError(f"{field} sensor.{table.name}.tap", table.tap, "no tap: a record has none", "remove it")
    sensor, recorder = chain_of(table)
    if math.isinf(sensor.range) and math.isinf(sensor.resonance) and sensor.mounting.direct:
        raise InputError(
            f"{field} sensor.{table.name}", MISSING, "a model, a range or a resonance", 'add model = "Endevco 2225"'
        )
    from_table = table.model and (table.range is None or table.resonance is None)
    model = accelerometer(table.model) if from_table else None
    return StatedSensor(sensor, recorder, model, tuple(memory_notices(table)))


def _only_table(file: Path, field: str) -> SensorTable:
    document = read_small_file(file, field, ALLOWED)
    if set(document) != {"sensor"}:
        raise InputError(field, str(file), ALLOWED, f"it has {', '.join(map(show, document)) or 'nothing'}")
    tables = FORM.read(document, f"{field} ").sensor
    if len(tables) != 1:
        raise InputError(field, str(file), ALLOWED, f"it has {len(tables)}")
    return tables[0]
