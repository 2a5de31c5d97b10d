"""Settings of a machine that give the blows asked for."""
