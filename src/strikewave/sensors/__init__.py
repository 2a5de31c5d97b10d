"""Reading of an accelerometer: mounting, resonance, range, filter, sampling and bits. Knows no units and no files."""

from strikewave.sensors.chain import (
    Accelerometer,
    Recorder,
    Sensor,
    SensorReading,
    accelerometer,
    accelerometers,
    oscilloscope,
    output,
    read,
    storage_recorder,
)
from strikewave.sensors.mounting import Gasket, Mounting, insertion_loss, transmission

__all__ = [
    "Accelerometer",
    "Gasket",
    "Mounting",
    "Recorder",
    "Sensor",
    "SensorReading",
    "accelerometer",
    "accelerometers",
    "insertion_loss",
    "oscilloscope",
    "output",
    "read",
    "storage_recorder",
    "transmission",
]
