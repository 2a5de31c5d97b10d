"""Inputs beyond what the laws of a machine hold for are named, and the built-in cases are not among them."""

import pytest

from strikewave import load_case, run_case
from strikewave.analyses.machine.build import release
from strikewave.cases.files import bundled_cases

CODES = {
    *("contact-longer-than-face", "nose-heavy", "spot-wider-than-face", "indentation-large", "approach-fast"),
    *("slowest-approach", "struck-while-fed", "first-blow-moving", "anvil-light", "rope-slack", "gas-not-ideal"),
    *("bodies-heavier-above", "no-gain", "gain-of-gaps", "contacts-overlap", "ball-mass"),
    *("faster-than-wave", "material-far", "not-reached", "strain-large"),
}
ROTARY, BALL, TABLE, ARM = "li-ma-2019", "iso-16063-22-dropball", "jesd22-b111-b", "machete-13-teeth"
ELASTIC = "contact.yield_pressure=900 GPa"
"""More than anything bears: the contact of a case that yields stays elastic, also on rubber, which has no hardness."""
GUN, LINE, DUAL = "en-166-ball", "rodgers-2009-amplifier", "dual-mass-amplifier"


def warned(name, *changes):
    """Return the notices of this file that a case raises, by their codes; of a rotary machine with one blow."""
    if load_case(name).feed is not None:
        changes = (*changes, "feed.blows=1")
    return {notice.code: notice for notice in run_case(load_case(name, changes)).notices if notice.code in CODES}


@pytest.mark.parametrize(
    ("name", "changes", "code", "words"),
    [
        (ROTARY, ["striker.contact_length=40 m"], "contact-longer-than-face", "striker.contact_length"),
        (ROTARY, ["striker.contact_length=40 m"], "nose-heavy", "more than the striker (1\xa0kg)"),
        (BALL, ["contact.law=palmgren", "striker.contact_length=1 m"], "contact-longer-than-face", "object.nose_mass"),
        (ROTARY, ["contact.slowest_approach=50 m/s"], "slowest-approach", "of 1 of 1 blows"),
        (ROTARY, ["feed.arrival=0.02"], "struck-while-fed", "feed.arrival"),
        (ROTARY, ["feed.stroke_time=200 ms"], "struck-while-fed", "short of its place"),
        (ROTARY, ["feed.stroke_time=5 ms"], "first-blow-moving", "feed.stroke_time"),
        (BALL, ["striker.mass=2 kg"], "ball-mass", "18.25\xa0mm radius (striker.nose_radius) of 45 steel"),
        (BALL, ["striker.nose_radius=36.5 mm"], "ball-mass", "has 1.599\xa0kg, not 0.2\xa0kg (striker.mass)"),
        (BALL, ["striker.material=rubber", ELASTIC], "ball-mass", "of rubber (striker.material)"),
        (BALL, ["striker.material=rubber", ELASTIC], "spot-wider-than-face", "object.nose_mass"),
        (BALL, ["striker.material=rubber", ELASTIC], "indentation-large", "of the radius"),
        (GUN, ["machine.speed=900 m/s"], "approach-fast", "rho v^2/2 > Y"),
        (GUN, ["machine.speed=900 m/s"], "approach-fast", "machine.speed = 900 m/s"),
        (GUN, ["machine.speed=9000 m/s"], "faster-than-wave", "machine.speed = 9000 m/s"),
        pytest.param(
            *("li-ma-2019-fig13", ["stack.layer.upper.modulus=211 kPa"], "not-reached", "tap sensor"),
            marks=pytest.mark.verify,
        ),
        (TABLE, ["striker.mass=1 kg"], "anvil-light", "striker.mount_stiffness"),
        (ARM, ["machine.mass=3 kg", "machine.centre=0.4 m", "machine.drum=2 m"], "rope-slack", "machine.drum"),
        (LINE, ["striker.mass=0.1 kg"], "bodies-heavier-above", "striker (0.1 kg) than third"),
        (LINE, ["object.mass=1 kg"], "no-gain", "does not amplify"),
        (LINE, ["machine.height=1 um"], "gain-of-gaps", "8 mm"),
        (LINE, ["machine.gap=10 um"], "contacts-overlap", "machine.gap"),
        (DUAL, ["object.mass=400 kg", "object.nose_mass=30 kg"], "no-gain", "does not amplify"),
    ],
)
def test_what_is_beyond_a_law_is_named_with_what_to_do(name, changes, code, words):
    found = warned(name, *changes)
    assert code in found, sorted(found)
    assert words in found[code].message


KNOWN = {
    "li-ma-2019-fig5": {"contact-longer-than-face"},
    "li-ma-2019-fig13": {"contact-longer-than-face"},
    "endevco-tp-321": {"indentation-large"},
    "en-166-ball": {"indentation-large"},
}
"""The built-in cases that reach beyond a law: a face of 30 mm under a nose of 40 mm, both assumed; an edge of 1 mm; a ball
at 45 m/s that dents its target by a tenth of its radius."""


def of_stacks(name):
    """Whether a case is the slow kind: it stands among the longer checks."""
    return pytest.param(name, marks=pytest.mark.verify) if load_case(name).stack.layer else name


@pytest.mark.parametrize("name", [of_stacks(name) for name in bundled_cases() if load_case(name).command == "run"])
def test_built_in_machines_lie_within_their_laws_but_for_what_is_known(name):
    assert set(warned(name)) == KNOWN.get(name, set())


def test_a_machete_lighter_than_its_arm_is_refused():
    with pytest.raises(ValueError, match=r"machine.inertia.*at least"):
        release(load_case(ARM, ["machine.mass=30 kg", "machine.centre=0.4 m"]))


def test_a_recorder_slower_than_the_pulse_is_told_what_it_needs():
    """Worst loss of a half-sine's peak by samples half an interval off, 1 - cos(pi/(2 n))."""
    for rate, words in (
        ("40 kHz", "may be 1.9 % low"),
        ("25 kHz", "may be 4.9 % low"),
        ("1 kHz", "80 % of the pulses"),
    ):
        solution = run_case(load_case(ROTARY, [f"recorder.sampling_rate={rate}", "feed.blows=1"]))
        (message,) = [notice.message for notice in solution.notices if notice.code == "recorder-rate"]
        assert words in message
