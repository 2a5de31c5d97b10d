"""A sphere on a flat by the finite elements of Jackson & Green 2005, as an independent loading curve.

In the form of Ghaednia et al. 2019: elastic up to 1.9 times the depth of first yield; from there the force that was
fitted to the elements, with the hardness 2.84 - 0.92 (1 - cos(pi a/R)) times the yield strength.
"""

import math


def jackson_green(strength, poissons_ratio, radius, modulus):
    """Return the depth of first yield, m, and half width and force over depth, m and N; SI."""
    c = 1.295 * math.exp(0.736 * poissons_ratio)
    depth = (math.pi * c * strength / (2 * modulus)) ** 2 * radius
    load = 4 / 3 * (radius / modulus) ** 2 * (c * math.pi * strength / 2) ** 3
    widen = 0.14 * math.exp(23 * strength / modulus)

    def half_width(d):
        return math.sqrt(radius * d * max(d / depth / 1.9, 1.0) ** widen)

    def force(d):
        q = d / depth
        if q < 1.9:
            return load * q**1.5
        hardness = 2.84 - 0.92 * (1 - math.cos(math.pi * half_width(d) / radius))
        plastic = 4 * hardness / c * (1 - math.exp(-(q ** (5 / 9)) / 25)) * q
        return load * (math.exp(-(q ** (5 / 12)) / 4) * q**1.5 + plastic)

    return depth, half_width, force
