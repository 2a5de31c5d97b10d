"""Which buffer under a sensor: candidates compared by what the sensor reads."""
