"""How much blows scatter within tolerances."""
