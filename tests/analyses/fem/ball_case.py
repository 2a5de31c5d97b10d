"""A ball on a block, as a case to change."""

CASE = """
schema = 1
title = "A ball on a block"

[[mesh.part]]
name = "ball"
shape = "ball"
material = "65Mn"
radius = "10 mm"
size = "2.5 mm"
sector = "quarter"
at = { z = { value = "14.01 mm", provenance = "measured", note = "gauge block" } }
velocity = { z = "-1 m/s" }
solid = { law = "bilinear", tangent_modulus = "21 GPa" }

[[mesh.part]]
name = "block"
shape = "block"
material = "2A12"
width = "10 mm"
depth = "8 mm"
height = "4 mm"
size = "2 mm"
elements = "full"

[fem]
duration = "80 us"
gravity = { z = "-1 g" }

[[fem.contact]]
first = "ball.round"
second = "block"
friction = 0.1

[[fem.boundary]]
kind = "symmetry"
side = "ball.x-"

[[fem.boundary]]
kind = "pressure"
side = "block.x+"
time = ["0 us", { value = "10 us", provenance = "measured" }]
pressure = ["0 MPa", "10 MPa"]
"""


def edited(*changes):
    """The case above with pieces of its text replaced."""
    text = CASE
    for old, new in changes:
        assert text.count(old) >= 1, old
        text = text.replace(old, new, 1)
    return text
