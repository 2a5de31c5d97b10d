"""The search of faces near the nodes of a contact, on a device; see `strikewave.fem.contact.searched`."""

from __future__ import annotations

from typing import Any

import numpy as np

from strikewave.fem import _boundary_kernels as boundary_kernels
from strikewave.fem._contact_kernels import ContactState
from strikewave.fem.contact import REACH
from strikewave.fem.device import _search_bodies as bodies
from strikewave.fem.device.devices import Device
from strikewave.fem.device.tables import lists
from strikewave.fem.mesh import Index

GROUP = 32
"""Faces of a group: a node then looks at a thirty-second of all boxes, and at those of the few groups it lies in."""


class FaceSearch:
    """Groups of the faces of two surfaces, and what a search writes."""

    def __init__(self, device: Device, here: ContactState) -> None:
        self.device, self.nodes, self.faces = device, len(here.touch.nodes), len(here.faces)
        split = here.first_faces
        edges = np.array([*range(0, split, GROUP), *range(split, self.faces, GROUP), self.faces], np.int32)
        corners = here.faces.ravel()
        self.corners = tuple(device.put(each) for each in lists(corners, np.arange(len(corners)), self.nodes))
        self.area, self.count = device.put(np.zeros(self.faces)), device.put(np.zeros(self.nodes, np.int64))
        self.groups = bodies.FaceGroups(
            device.put(edges),
            device.put(np.zeros((self.faces, 6))),
            device.put(np.zeros((len(edges) - 1, 6))),
            int(np.searchsorted(edges, split)),
        )

    def near(self, there: ContactState, x: Any) -> tuple[Index, Any, Any]:
        """Renew areas and boxes for where the nodes are now.

        Returns
        -------
        start, there_start, candidates : array
            Where the faces of each node begin, here and there; the faces, there.
        """
        each, groups = self.device.each, self.groups
        each(boundary_kernels.take_row, self.nodes, there.touch.nodes, x, there.place)
        each(bodies.survey_face, self.faces, there, REACH, groups.boxes, self.area)
        each(bodies.survey_node, self.nodes, there, *self.corners, self.area)
        each(bodies.bound_group, len(groups.bounds), groups)
        each(bodies.count_near, self.nodes, there, groups, self.count)
        start = np.append(0, np.cumsum(self.device.get(self.count)))
        begin, candidates = self.device.put(start), self.device.put(np.zeros(start[-1], np.int32))
        each(bodies.fill_near, self.nodes, there, groups, begin, candidates)
        return start, begin, candidates
