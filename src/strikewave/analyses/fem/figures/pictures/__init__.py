"""Pictures of the parts of an explicit run in space: cut open, deformed, coloured by what a field says.

`body_picture` draws with matplotlib alone, without a screen: the exterior faces of the elements that a cut leaves are
seen along parallel lines and painted from the farthest to the nearest. Faces that are large against the picture are
divided first, so that painting by distance goes wrong nowhere by more than the size of such a piece. `scene` draws
the same with pyvista, where that is installed.
"""

from strikewave.analyses.fem.figures.pictures.bodies import body_picture, frames_picture, mesh_picture
from strikewave.analyses.fem.figures.pictures.camera import Camera, contact_zone, kept_elements, view_of
from strikewave.analyses.fem.figures.pictures.fields import QUANTITIES
from strikewave.analyses.fem.figures.pictures.vtk_scene import scene

__all__ = [
    "QUANTITIES",
    "Camera",
    "body_picture",
    "contact_zone",
    "frames_picture",
    "kept_elements",
    "mesh_picture",
    "scene",
    "view_of",
]
