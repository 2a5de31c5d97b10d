"""One planted draw: its truth, what is reported of it, and a picture."""

import planted_judge
from planted import classes
from planted_judge import G, of, rigid

FILES = 4
"""Files of a campaign that are shown, those with a fault first."""


def show(kind, seed, folder):
    """Print one draw and what is reported of it, write a picture into a folder, and return its path."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    draw = classes.draw(kind, seed)
    verdict = planted_judge.judged(draw)
    files, campaign = planted_judge.read(draw)
    order = sorted(range(len(files)), key=lambda k: (not (k in draw.odd or verdict.files[k].silent), k))[:FILES]
    figure, axes = pyplot.subplots(len(order), 2, figsize=(14, 3.2 * len(order)), squeeze=False)
    for pair, k in zip(axes, order, strict=True):
        _print(draw.files[k], files[k], verdict.files[k])
        _draw(pair, draw.files[k], files[k])
        pair[0].set_title(f"{kind}, seed {seed}, {draw.files[k].name}: true v, reported x")
    if campaign is not None and "peak" in campaign.statistics:
        said = campaign.statistics["peak"]
        print(f"campaign: mean {said.mean / G:.5g} g, CV {said.cv:.1%}, n {said.n}")
        for entry in campaign.left_out:
            print("  left out:", *entry)
    print(f"silent misses: {verdict.silent or 'none'}")
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{kind}-{seed}.png"
    figure.tight_layout()
    figure.savefig(path, dpi=90)
    return path


def _print(draft, file, verdict):
    how, [reading] = draft.setting, file.channels
    shape = f"{how.shape.name}{tuple(round(p, 3) for p in how.shape.parameters)}"
    print(
        f"{draft.name}: {shape}, {how.per_width:.3g} samples a width of {1e3 * how.width:.4g} ms, {draft.values.size} samples"
    )
    print("  faults: " + ", ".join(f"{name} {value}" for name, value in draft.faults.items()))
    for blow in draft.blows:
        peak, raw, change = (draft.sign * v for v in (blow.peak, blow.raw_peak, blow.velocity_change * G))
        print(
            f"  true     {draft.begin_time + blow.time:12.6g} s  peak {peak:10.5g} g (with ringing {raw:.5g})  width {1e3 * blow.width:.5g} ms  dv {change:.5g} m/s"
        )
    for pulse in reading.pulses:
        alone = rigid(pulse)
        text = (
            ""
            if alone is None
            else f"  without ringing {of(alone, 'peak') / G:.5g} g, {1e3 * of(alone, 'width'):.5g} ms"
        )
        print(
            f"  reported {pulse.time:12.6g} s  peak {pulse.peak / G:10.5g} g (smooth {pulse.smooth.peak / G:.5g})  width {1e3 * pulse.width:.5g} ms  "
            f"dv {pulse.velocity_change:.5g} m/s  {pulse.method}, zero {pulse.offset / G:.4g} g{text}"
        )
    for finding in file.all_findings:
        print(
            f"  {finding.severity:8}{finding.code}: {finding.message} [harms {', '.join(finding.harms) or 'nothing'}]"
        )
    print(f"  silent misses: {verdict.silent or 'none'}; withheld though right: {verdict.withheld or 'none'}")


def _draw(pair, draft, file):
    how, [reading] = draft.setting, file.channels
    time = 1e3 * (draft.begin_time + draft.time)
    for ax in pair:
        ax.plot(time, draft.values, lw=0.8, marker="." if how.per_width < 40 else "", ms=3)
        for blow in draft.blows:
            ax.plot(1e3 * (draft.begin_time + blow.time), draft.sign * blow.peak, "gv", fillstyle="none")
        for pulse in reading.pulses:
            ax.plot(1e3 * pulse.time, (pulse.peak + pulse.offset) / G, "rx")
        ax.set(xlabel="time in ms", ylabel="acceleration in g")
    middle = 1e3 * (draft.begin_time + (draft.blows[0].time if draft.blows else 0.5 * draft.time[-1]))
    pair[1].set_xlim(middle - 4e3 * how.width, middle + 8e3 * how.width)
    pair[1].set_title(" ".join(f"{f.code}:{f.severity}" for f in file.all_findings) or "good", fontsize=8)
