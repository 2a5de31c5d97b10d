"""The numbered equations of Li & Ma 2019, one row each: words from equations.toml, numbers computed when called."""

from __future__ import annotations

import functools
import tomllib
from importlib import resources
from typing import Any

from strikewave.papers.li_ma_2019.contact_equations import contact_values
from strikewave.papers.li_ma_2019.examples import ContactExample, WaveExample
from strikewave.papers.li_ma_2019.types import EquationRow
from strikewave.papers.li_ma_2019.values import Values
from strikewave.papers.li_ma_2019.wave_equations import wave_values


def equation_rows(contact: ContactExample | None = None, wave: WaveExample | None = None) -> tuple[EquationRow, ...]:
    """Return all numbered equations in their order, with what they give on an example.

    Parameters
    ----------
    contact : ContactExample, optional
        For (1) to (25).
    wave : WaveExample, optional
        For (26) to (40).

    Examples
    --------
    >>> rows = equation_rows()
    >>> len(rows), rows[14].number, rows[14].verdict, round(rows[14].deviation, 4)
    (41, '(15)', 'approximate', -0.0353)
    """
    values = {**contact_values(contact or ContactExample()), **wave_values(wave or WaveExample())}
    return tuple(_row(words, values[words["number"]]) for words in _table())


@functools.cache
def _table() -> tuple[dict[str, Any], ...]:
    text = (resources.files("strikewave.papers.li_ma_2019") / "equations.toml").read_text("utf-8")
    return tuple(tomllib.loads(text)["equation"])


def _row(words: dict[str, Any], values: Values) -> EquationRow:
    """Join the words of an equation and its numbers."""
    texts = {key: words[key].format(**values.words) for key in ("quantity", "note")}
    filled = {"corrected": "", "corrected_tex": "", **words, **texts}
    return EquationRow(**filled, printed=values.printed, corrected_value=values.corrected, exact=values.exact)
