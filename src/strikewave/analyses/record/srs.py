"""``strikewave srs``: the shock response spectrum of a measured record."""

from __future__ import annotations

from strikewave.analyses.record.options import Spectra
from strikewave.reporting import measured_files as measured
from strikewave.reporting.output_options import Output


def command(
    files: measured.Files,
    *,
    spectra: Spectra,
    measurement: measured.MeasurementOptions,
    spec: measured.Spec = None,
    judging: measured.SpectraJudging,
    filtering: measured.Filtering,
    output: Output,
) -> int:
    """Compute shock response spectra.

    They are those of a record, its baseline taken off. Of several files, or channels, their envelope is given, and from
    three on the limit P95/50. --spec judges each by a specification, which then states frequencies, Q and side. With
    --json, no files are written unless --out is given. The exit code is 3 where the verdict is FAIL.
    """
    from strikewave.analyses.record.spectrum_screen import compute_spectra

    return compute_spectra(files, spectra, measurement, filtering, judging, judging.specification(spec), output)
