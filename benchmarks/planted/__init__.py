"""Records whose truth is known: numpy, scipy and a file format, nothing of the package that reads them.

blows: the records of the table by decibels. shapes, noises: what a record is made of; drafts: a record in the making,
with its truth; faults: what can go wrong with it, each with a strength; classes: what is drawn.
"""

from .blows import Blow, Planted, plant, write

__all__ = ["Blow", "Planted", "plant", "write"]
