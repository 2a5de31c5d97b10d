"""Li & Ma 2019 equation by equation and number by number: as printed, corrected, exact."""
