"""The sources that models and materials stand on, each under a short key.

A model names its key in its docstring and in the results it takes part in, so that a report can
print what it rests on.
"""

from __future__ import annotations

from strikewave.errors import InputError, nearest

SOURCES: dict[str, str] = {
    "li-ma-2019": (
        "F. Li, S. Ma, Analysis and Experimental Study of Acceleration Model for Short Interval and "
        "Multiple Impact Equipment, Shock and Vibration 2019, 5139137, doi:10.1155/2019/5139137"
    ),
    "hunt-crossley-1975": (
        "K. H. Hunt, F. R. E. Crossley, Coefficient of Restitution Interpreted as Damping in "
        "Vibroimpact, Journal of Applied Mechanics 42 (1975) 440-445, doi:10.1115/1.3423596"
    ),
    "palmgren": (
        "A. Palmgren, Ball and Roller Bearing Engineering, 3rd ed., Burbank, Philadelphia 1959; in the "
        "form of eqs (2)-(4) of Li & Ma 2019 with the equivalent modulus of eq (5) inverted"
    ),
    "johnson-1985": "K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, ch. 4 (Hertz)",
    "kolsky-1963": "H. Kolsky, Stress Waves in Solids, Dover, New York 1963, ch. III (bars)",
    "hairer-1993": (
        "E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., "
        "Springer 1993, sections II.5-II.6 (DOP853)"
    ),
    "takahasi-mori-1974": (
        "H. Takahasi, M. Mori, Double Exponential Formulas for Numerical Integration, Publ. RIMS "
        "Kyoto Univ. 9 (1974) 721-741"
    ),
    "schwager-poschel-2007": (
        "T. Schwager, T. Poschel, Coefficient of restitution and linear-dashpot model revisited, "
        "Granular Matter 9 (2007) 465-469, doi:10.1007/s10035-007-0065-z"
    ),
    "emmerich-korn-1987": (
        "H. Emmerich, M. Korn, Incorporation of attenuation into time-domain computations of seismic wave "
        "fields, Geophysics 52 (1987) 1252-1264, doi:10.1190/1.1442386"
    ),
    "van-loan-1978": (
        "C. F. Van Loan, Computing Integrals Involving the Matrix Exponential, IEEE Transactions on "
        "Automatic Control 23 (1978) 395-404"
    ),
    "smallwood-1981": (
        "D. O. Smallwood, An improved recursive formula for calculating shock response spectra, Shock and "
        "Vibration Bulletin 51 (1981) 211-217"
    ),
    "iso-18431-4": (
        "ISO 18431-4:2007, Mechanical vibration and shock - Signal processing - Part 4: Shock-response spectrum "
        "analysis"
    ),
    "goldenshluger-nemirovski-1997": (
        "A. Goldenshluger, A. Nemirovski, On spatially adaptive estimation of nonparametric regression, "
        "Mathematical Methods of Statistics 6 (1997) 135-170"
    ),
    "siegel-1982": ("A. F. Siegel, Robust regression using repeated medians, Biometrika 69 (1982) 242-244"),
    "vangel-1996": (
        "M. G. Vangel, Confidence intervals for a normal coefficient of variation, The American Statistician "
        "50 (1996) 21-26"
    ),
    "sae-j211": ("SAE J211-1, Instrumentation for impact test, part 1: electronic instrumentation, appendix C"),
    "patera-1984": (
        "A. T. Patera, A spectral element method for fluid dynamics: laminar flow in a channel expansion, "
        "Journal of Computational Physics 54 (1984) 468-488"
    ),
}


def citation(key: str) -> str:
    """Return the full reference of a key.

    Raises
    ------
    InputError
        If the key is unknown.

    Examples
    --------
    >>> citation("johnson-1985").startswith("K. L. Johnson")
    True
    """
    if key not in SOURCES:
        raise InputError("citation", key, "a known source", nearest(key, SOURCES))
    return SOURCES[key]
