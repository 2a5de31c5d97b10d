"""Records whose truth is known: numpy and scipy, nothing of the package that reads them.

shapes, noises: what a record is made of; drafts: a record in the making, with its truth; faults: what can go wrong
with it, each with a strength; classes: what is drawn.
"""
