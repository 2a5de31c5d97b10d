"""The list of commands, the help of each, completion, and what is said of a wrong word."""

import inspect
import json
import subprocess
import sys
import typing

import pytest

from strikewave.cli.group import PANELS, command_function, entries

HEAVY = ("numpy", "numba", "scipy", "pint", "pydantic", "xarray", "matplotlib", "jinja2", "tomlkit", "rich")
"""Libraries that take a tenth of a second each, or more."""


def test_summary_of_the_list_is_the_first_line_of_the_help():
    for name, entry in entries().items():
        function = command_function(entry.module)
        assert inspect.getdoc(function).splitlines()[0] == entry.summary, name


def test_list_shows_every_summary_whole_in_its_panel(strikewave, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    code, out, _ = strikewave("--help")
    assert code == 0
    lines = out.splitlines()
    assert all(len(line) <= 80 for line in lines)
    for panel, rows in PANELS.items():
        begin = lines.index(f"{panel}:") + 1
        shown = [line.split(maxsplit=1) for line in lines[begin : begin + len(rows)]]
        assert shown == [[name, summary] for name, (_, summary) in rows.items()]
        assert all(len(summary) <= 45 for _, summary in rows.values())


@pytest.mark.parametrize("words", [["--help"], []])
def test_list_imports_no_command_and_no_heavy_library(words, environment):
    program = (
        f"import sys; sys.argv = ['strikewave', *{words!r}]\nfrom strikewave.cli import app\n"
        f"try: app.main()\nfinally: print([m for m in sys.modules if m in {HEAVY!r} or m.endswith('.command')])"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, env=environment)
    assert run.stdout.splitlines()[-1] == "[]"


@pytest.mark.verify
@pytest.mark.parametrize("name", entries())
def test_help_of_a_command_runs_nothing_heavy(name, environment):
    program = (
        f"import sys; sys.argv = ['strikewave', {name!r}, '--help']\nfrom strikewave.cli import app\n"
        "heavy = ('numba', 'scipy', 'xarray', 'matplotlib', 'jinja2')\n"
        "try: app.main()\nfinally: print([m for m in heavy if m in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, env=environment)
    assert run.stdout.splitlines()[-1] == "[]"
    assert entries()[name].summary in run.stdout


@pytest.mark.parametrize("name", entries())
def test_every_option_is_described_by_a_phrase(strikewave, name):
    code, out, err = strikewave("help", name)
    assert (code, err) == (0, "")
    assert strikewave(name, "--help")[1] == out
    assert f"Usage: strikewave {name}" in out
    assert "<str>" not in out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["rnu"], 'no such command: rnu; did you mean "run"?; see `strikewave --help`'),
        (["help", "rnu"], 'no such command: rnu; did you mean "run"?; see `strikewave --help`'),
        (["run"], "CASE: missing; needed: a case file, or the name of a built-in case; see `strikewave run --help`"),
        (["run", "x", "--anmate"], 'strikewave run has no option --anmate; did you mean "--animate"?; see `strikewave run --help`'),
        (["run", "x", "--hist"], 'strikewave run has no option --hist; did you mean "--histories"?'),
        (["materials", "x"], "strikewave materials: too many arguments: x; put quotes around a value that has a space"),
        (["record", "-rf.csv"], "-rf.csv, write ./-rf.csv"),
        (["srs", "--unit", "g", "--out.csv"], "--out.csv, write ./--out.csv"),
        (["fem", "x", "--threads"], "strikewave fem: option '--threads' requires an argument; see `strikewave fem --help`"),
        (["fem", "x", "--threads", "0"], "--threads: got 0; allowed: a whole number, at least 1; see `strikewave fem --help`"),
        (["impact", "--repeat", "2.5"], "--repeat: got 2.5; allowed: a whole number from 1 to 1000; see"),
        (["wave", "x", "--field", "strss"], 'allowed: one of stress, force, velocity; did you mean "stress"?'),
        (["impact", "--m1", "2 m"], '--m1: got "2 m"; allowed: a mass with its unit, such as "0.459 kg"'),
        (["impact", "--m1", "0"], '--m1: got "0"; allowed: a mass above zero, or inf'),
        (["impact", "-e", "2"], '--restitution: got "2"; allowed: a number above 1e-06 and at most 1'),
        (["srs", "x", "--kind", "relative"], "allowed: one of absolute, displacement, relative-velocity, pseudo-velocity"),
        (["map", "x", "--points", "6x6x6"], '--points: got "6x6x6"; allowed: two whole numbers; such as 200x200'),
        (["map", "x", "--want-cv", "200 %"], '--want-cv: got "200 %"; allowed: a share above 0 and below 1, such as 2 %'),
        (["map", "x", "--log", "z"], '--log: got "z"; allowed: x or y'),
        (["buffer", "x", "--limit", "5000"], '--limit: got "5000"; allowed: an acceleration with its unit'),
        (["settings", "--peak", "4000 g"], "--interval: missing; needed: time between blows"),
        (["ls-dyna", "x"], "--units: missing; needed: one of SI, mm-t-s, mm-ms-kg, mm-g-us; see"),
        (["reproduce", "smith-2020"], 'PAPER: got "smith-2020"; allowed: li-ma-2019'),
    ],
)  # fmt: skip
def test_a_wrong_word_is_one_line_that_names_option_and_what_is_allowed(strikewave, words, said):
    code, out, err = strikewave(*words)
    assert (code, out) == (2, "")
    assert said in err
    assert len(err.splitlines()) == 1


def completed(words, environment):
    """Return what bash would offer for the last word."""
    variables = {"_STRIKEWAVE_COMPLETE": "complete_bash", "COMP_WORDS": words, "COMP_CWORD": str(words.count(" "))}
    command = [sys.executable, "-m", "strikewave"]
    run = subprocess.run(command, capture_output=True, text=True, check=True, env={**environment, **variables})
    return run.stdout.split()


@pytest.mark.verify
@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("strikewave s", ["srs", "spec", "settings", "sweep", "scatter"]),
        ("strikewave run li-ma-2019-eq", ["li-ma-2019-equal-blows"]),
        ("strikewave run li-ma-2019 --an", ["--animate"]),
        ("strikewave wave x --field ", ["stress", "force", "velocity"]),
        ("strikewave srs x --kind d", ["displacement"]),
        ("strikewave new mine.toml --from hop", ["hopkinson"]),
        ("strikewave validate min", ["mine.toml"]),
        ("strikewave help sr", ["srs"]),
    ],
)
def test_the_shell_completes_commands_options_cases_and_choices(words, offered, environment, tmp_path, monkeypatch):
    (tmp_path / "mine.toml").write_text("schema = 1\n")
    monkeypatch.chdir(tmp_path)
    assert completed(words, environment) == offered


def test_completion_names_what_the_libraries_know():
    """Choices stand as literals in signatures, so that a help imports no library; both are the same."""
    from strikewave.analyses.fem.decks import CODES
    from strikewave.analyses.layered_bars import QUANTITIES
    from strikewave.analyses.record import options
    from strikewave.cases.files import bundled_cases
    from strikewave.contact.law import SHAPES
    from strikewave.exchange.units import SYSTEMS
    from strikewave.papers.li_ma_2019.result import PAPER
    from strikewave.reporting.options import complete_case
    from strikewave.signal.oscillators import KINDS
    from strikewave.signal.srs import PARTS
    from strikewave.studies.buffer.stacks import RANKS
    from strikewave.studies.map.figures import COLOURS
    from strikewave.studies.scatter.study import METHODS
    from strikewave.studies.search.rotary import VARIED

    assert set(options.KINDS) == set(KINDS)
    assert complete_case("")[: len(bundled_cases())] == bundled_cases()
    for name, option, known in (
        ("wave", "field", QUANTITIES), ("deck", "code", CODES), ("deck", "units", SYSTEMS), ("ls-dyna", "units", SYSTEMS),
        ("map", "colour", COLOURS), ("scatter", "shares", METHODS), ("settings", "vary", VARIED), ("buffer", "rank", RANKS),
        ("srs", "part", PARTS), ("reproduce", "paper", [PAPER]), ("impact", "shape", SHAPES),
    ):  # fmt: skip
        assert choices(name, option) == set(known), (name, option)


def choices(name, option):
    """Return the choices of an option, alone or in a group."""
    from strikewave.cli.group import spread

    function = spread(command_function(entries()[name].module))
    kind = typing.get_type_hints(function)[option]
    literal = next(part for part in (kind, *typing.get_args(kind)) if typing.get_origin(part) is typing.Literal)
    return set(typing.get_args(literal))


def test_a_quantity_that_is_no_number_of_the_file_is_shown_as_typed():
    import pickle

    from strikewave.reporting.options import Typed

    held = Typed(1e6, "1 MHz")
    assert (held, held.word, repr(held)) == (1e6, "1 MHz", "1000000.0")
    assert type(pickle.loads(pickle.dumps(held))) is float
    assert json.dumps(held) == "1000000.0"


FILES_ONLY = ("xarray", "pandas", "pyarrow", "h5py", "h5netcdf", "matplotlib", "jinja2")
"""Libraries that files, pictures and pages need, and nothing else."""
ONE_BLOW = ["run", "li-ma-2019", "--set", "feed.blows=1"]


@pytest.mark.verify
@pytest.mark.parametrize("band", [[], ["--no-band"]])
@pytest.mark.parametrize("words", [ONE_BLOW, ["wave", "li-ma-2019-fig13-bar"]])
def test_json_draws_nothing_and_imports_no_library_for_it(words, band, environment, tmp_path):
    program = (
        f"import sys; sys.argv = ['strikewave', *{[*words, *band]!r}, '--json']\nfrom strikewave.cli import app\n"
        f"heavy = (*{FILES_ONLY!r}, 'pint', 'scipy.signal', 'scipy.stats', 'strikewave.hopkinson')\n"
        "try: app.main()\nfinally: print([m for m in heavy if m in sys.modules], file=sys.stderr)"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, env=environment, cwd=tmp_path, check=False
    )
    assert json.loads(run.stdout)["schema"]
    assert run.stderr.splitlines()[-1] == "[]"


@pytest.mark.verify
def test_files_and_page_of_a_run_are_written_without_xarray(environment, tmp_path):
    """xarray and pandas take a third of a second to import: only who reads histories in Python needs them."""
    program = (
        f"import sys; sys.argv = ['strikewave', *{ONE_BLOW!r}, '--no-band', '--out', 'run', '-q']\n"
        "from strikewave.cli import app\n"
        "try: app.main()\nfinally: print([m for m in ('xarray', 'pandas', 'pyarrow') if m in sys.modules])"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, env=environment, cwd=tmp_path, check=True
    )
    assert (tmp_path / "run" / "solution.nc").is_file()
    assert run.stdout.splitlines()[-1] == "[]"
