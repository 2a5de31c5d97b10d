"""The bands of a machine's run: the same machine with its inputs moved within what is known of them.

A rotary machine runs by the fast engine (`strikewave.machines.fast_train`), a stack as two bodies on its frame; the
first blow has further runs, since few passes are cheap. A machine that strikes once, or that the fast engine does not
hold for, runs as it is. Sensors need the whole history of a blow, on a stack with its waves: few such runs are made.
"""

from __future__ import annotations

import dataclasses
import math
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from statistics import median
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.run import RunSeen
from strikewave.base.errors import InputError, InputErrors, IntegrationError
from strikewave.base.result import Band
from strikewave.cases.case import Case
from strikewave.machines import Machine, blows, run_machine
from strikewave.machines.fast_train import fast_train, why_not
from strikewave.uncertainty.bands import RUNS_STREAM, SEED, BandMethod, Sample, find_bands, latin_hypercube
from strikewave.uncertainty.draws import FELT, UncertainInput, drawn, drawn_case
from strikewave.uncertainty.known import known_inputs
