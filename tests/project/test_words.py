"""The words that users read are the field's: no old word is left in help, messages, docstrings, pages or cases."""

import ast
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import pytest

from strikewave.cli.group import entries, whole_command

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src" / "strikewave"
PAGES = sorted([*ROOT.glob("docs/*.md"), *ROOT.glob("*.md")])
CASES = sorted(SOURCE.rglob("*.toml"))
TEMPLATES = sorted([*SOURCE.rglob("*.html"), *SOURCE.rglob("*.js")])
MODULES = sorted(SOURCE.rglob("*.py"))


class Word(NamedTuple):
    """An old word: what finds it, what to say instead, and texts that hold it.

    ``^`` and ``$`` are begin and end of a text: a string, a paragraph, a cell of a table.
    """

    pattern: str
    say: str
    planted: tuple[str, ...]


WORDS = (
    Word(r"\bledgers?\b", "energy balance, momentum balance", ("The energy ledger is off by 4 %.", "Ledgers")),
    Word(r"\bretreat(s|ed|ing)?\b", "largest displacement (rearward)", ("largest retreat after first touch",)),
    Word(r"^width( \([µu]s\))?$", "pulse width at 10 %", ("width (µs)", "Width")),
    Word(r"^rise( \([µu]s\))?$", "rise time 10-90 %", ("rise (us)", "Rise")),
    Word(r"\bzero lines?\b", "baseline", ("The zero line is taken off.",)),
    Word(r"\b(un)?even clock\b|\bclock (is|was) (not |un)?even\b", "uniform sampling", ("an even clock",)),
    Word(r"\bblows? that begins? in noise\b", "onset", ("a blow that begins in noise",)),
    Word(
        r"\bbeside (the )?(published|computed)\b|\bpublished numbers? beside\b",
        "comparison with published values",
        ("Published beside computed", "every published number beside what is computed"),
    ),
    Word(
        r"\bmodels? of hexahedra\b|^#+ .*\bhexahedr",
        "explicit finite elements (8-node hexahedra)",
        ("A model of hexahedra as a deck.", "## Hexahedra in motion"),
    ),
    Word(
        r"\bsplit[_-]bars?\b|\bsplit bar command\b|\bstrikewave (bar|stack|elements)\b|\belements(-theory)?\.md\b",
        "one name for room, command and docs: hopkinson, wave, fem",
        ("[elements](elements.md)", "a split-bar set-up", "run strikewave stack"),
    ),
    Word(r"\b(hangs?|hanging|hung) on\b", "depends on", ("The duration hangs on the stiffness.",)),
    Word(
        r"\bwithout a word\b|\btold\b(?! (apart|from))|\b(say|says|said) so\b|\bin silence\b",
        "no warning; is reported; warns",
        ("differs without a word", "What was cut off is always told.", "It is assumed, and the run says so."),
    ),
    Word(
        r"\bstated limits?\b|\bno limit (is |was )?broken\b",
        "a check failed; all checks passed",
        ("no stated limit broken", "No limit is broken."),
    ),
    Word(r"\bweight: to know\b|^to know$", "severity: info", ("weight: to know", "to know")),
    Word(r"\bclear of zero\b", "significant (95 %)", ("clear of zero: no",)),
    Word(
        r"\bfront of (the )?peak\b|\bon the front\b|^front$",
        "Pareto-optimal",
        ("* on the front of peak and bandwidth", "Front"),
    ),
    Word(
        r"\bof what is drawn\b|\bgives? the same (bits|draws|runs)\b|\bthe same bits\b",
        "random seed; equal seeds reproduce the run bit for bit",
        ("Of what is drawn.", "The same seed gives the same bits."),
    ),
    Word(r"\bladders?\b", "the values themselves", ("A ladder by default.",)),
    Word(
        r"^of one\b|(?<!may be )\brepeated\.$",
        "state the default; may be repeated",
        ("Of one.", "One gasket; repeated."),
    ),
    Word(r"\bin equal ratios\b", "logarithmic spacing along x or y", ("x or y: in equal ratios",)),
    Word(r"\ba file that exists\b", "no such file: x", ('got "x"; allowed: a file that exists',)),
    Word(
        r"\bpublished cases?\b|\b(cases?|come) (that )?comes? along\b|\bbundled cases?\b",
        "built-in case",
        ("the published cases that come along", "another published case"),
    ),
    Word(r"\bto and fro\b", "multiple reflections", ("the wave passing to and fro",)),
    Word(r"\bsurplus\b", "excess impulse", ("impulse in surplus",)),
    Word(
        r"\blaw is stretched\b|\bstretche[sd] the (elastic )?law\b",
        "the elastic law is outside its range",
        ("the elastic law is stretched",),
    ),
)
"""One row for each old word of what users see, in the order of the glossary."""
FIRST_USE = {"restitution": r"coefficients? of restitution", "engagement": r"engagement.{0,60}radial overlap"}
"""A term, and how it stands where a page of ``docs``, the README or the help of a command first uses it."""


def found_in(*paragraphs: str) -> list[tuple[str, str]]:
    """Return the old words in paragraphs, each with what to say instead."""
    lines = "\n".join(" ".join(text.split()) for text in paragraphs).lower()
    matches = ((re.search(word.pattern, lines, re.MULTILINE), word.say) for word in WORDS)
    return [(match[0], say) for match, say in matches if match]


BEFORE_AND_AFTER = re.compile(r"\| not \| but \|\n(\|.*\n)+")
"""The table of the style guide, whose first column holds what is not to be written."""


def without_code(text: str) -> str:
    return re.sub(r"```.*?```|``[^`]*``|`[^`]*`|\n    [^\n]*(?=\n)", " ", text, flags=re.DOTALL)


def paragraphs(text: str) -> Iterator[str]:
    """Cut a page at empty lines, headings and cells of tables."""
    for block in re.split(r"\n\s*\n|\n(?=#+ )|(?<=\n)(?=#+ )", text):
        rows = [row for row in block.split("\n") if row.lstrip().startswith("|")]
        yield "\n".join(row for row in block.split("\n") if row not in rows)
        yield from (cell.strip() for row in rows for cell in row.split("|"))


KEY = re.compile(r"[a-z0-9_./*\[\]-]*")


def strings(path: Path) -> Iterator[str]:
    """Yield what may be read of a module: docstrings without their code, and text that is no key or name."""
    inner: list[object] = [ast.parse(path.read_text("utf-8"))]
    for node in inner:  # which grows: four times as fast as ast.walk
        for value in vars(node).values():
            if isinstance(value, ast.AST):
                inner.append(value)
            elif isinstance(value, list):
                inner += [part for part in value if isinstance(part, ast.AST)]
            elif isinstance(value, str) and isinstance(node, ast.Constant) and not KEY.fullmatch(value):
                yield re.sub(r"``[^`]*``", "", value)


def help_of(name: str) -> str:
    """Return summary, help and help of the options of a command."""
    command = whole_command(name, entries()[name].module)
    options = [getattr(parameter, "help", None) or "" for parameter in command.params]
    return "\n\n".join([entries()[name].summary, command.help or "", *options])


def first_use(term: str, text: str) -> bool:
    """Tell whether a term is not used, or explained where it is used first."""
    flat = " ".join(without_code(text).split())
    first = re.search(rf"\b{term}\b", flat, re.IGNORECASE)
    explained = [match.span() for match in re.finditer(FIRST_USE[term], flat, re.IGNORECASE)]
    return not first or any(begin <= first.start() and first.end() <= end for begin, end in explained)


def old_words(path: Path, texts: Iterator[str]) -> list[str]:
    place = path.relative_to(ROOT)
    return [f'{place}: "{old}": say {say}' for old, say in found_in(*texts)]


@pytest.mark.parametrize("path", [*PAGES, *CASES, *TEMPLATES], ids=lambda path: path.name)
def test_pages_cases_and_templates_use_the_words_of_the_field(path):
    text = path.read_text("utf-8")
    if path.suffix == ".toml":
        text = re.sub(r"\n# ?", "\n", text)  # comments run over lines
    assert old_words(path, paragraphs(BEFORE_AND_AFTER.sub("", text))) == []


def test_strings_and_docstrings_use_the_words_of_the_field():
    assert [
        line for path in MODULES for line in old_words(path, (p for s in strings(path) for p in paragraphs(s)))
    ] == []


@pytest.mark.parametrize("name", sorted(entries()))
def test_the_help_of_each_command_uses_the_words_of_the_field(name):
    text = help_of(name)
    assert found_in(*paragraphs(text)) == []
    assert [term for term in FIRST_USE if not first_use(term, text)] == []


@pytest.mark.parametrize(
    "page",
    [page for page in PAGES if page.parent.name == "docs" or page.name == "README.md"],
    ids=lambda page: page.name,
)
def test_a_page_explains_a_term_where_it_first_uses_it(page):
    assert [term for term in FIRST_USE if not first_use(term, page.read_text("utf-8"))] == []


@pytest.mark.parametrize("word", WORDS, ids=lambda word: word.planted[0])
def test_a_planted_old_word_is_found_wherever_it_stands(word, tmp_path):
    for planted in word.planted:
        assert word.say in [say for _, say in found_in(planted)]
        module, broken = tmp_path / "module.py", planted.replace(" ", "\n    ", 1)
        module.write_text(f"def f(x):\n    '''{broken}'''\n    return {planted!r}, f{(planted + '{x}')!r}\n", "utf-8")
        read = [text for text in strings(module) if found_in(text)]
        assert len(read) >= 2 - word.pattern.startswith("^")
        assert [
            cell for cell in paragraphs(f"# Page\n\n| a | b |\n| --- | --- |\n| {planted} | 1 |\n") if found_in(cell)
        ]


def test_the_fields_own_words_are_not_found():
    """Words that hold an old one, or stand beside it in code, stay as they are."""
    fine = (
        "energy balance", "the retraction begins", "pulse width at 10 % (µs)", "rise time 10-90 %", "width of the face",
        "baseline", "uniform sampling", "explicit finite elements (8-node hexahedra)", "hexahedra of 8 nodes",
        "split Hopkinson bar", "strikewave hopkinson", "cannot be told apart", "may be repeated", "Pareto-optimal",
        "published values", "built-in cases", "excess impulse", "the wave front", "the weight of the object",
    )  # fmt: skip
    assert [text for text in fine if found_in(text)] == []
    assert first_use("restitution", "The coefficient of restitution e; the restitution then falls.")
    assert not first_use("restitution", "The restitution e.")
    assert first_use("restitution", "The field `contact.restitution`.")


def test_percents_are_written_by_one_function():
    """As `base/texts.py` writes them, with a space before the sign: Python's own format has none."""
    form = re.compile(r"\{[^{}\n]*:[^{}\n]*%\}")
    assert form.search('f"{share:.1%} of it"')
    slips = [f"{path.name}: {slip}" for path in (*MODULES, *CASES) for slip in form.findall(path.read_text("utf-8"))]
    assert slips == []


ROUNDED = re.compile(r":[,+]?\.\d+g\}")
"""A number of a text with so many digits: from as many before the point on it has an exponent, as "4.6e+02 %"."""


def with_exponents(text):
    """Return the lines of a module in which a number may get an exponent."""
    return [line.strip() for line in text.splitlines() if ROUNDED.search(line)]


@pytest.mark.parametrize("path", [path for path in MODULES if "notices" in path.stem], ids=lambda path: path.stem)
def test_numbers_of_notices_are_written_as_plain_digits(path):
    """`strikewave.base.texts.plain` writes them."""
    assert with_exponents(path.read_text("utf-8")) == []


def test_a_planted_number_with_an_exponent_is_found():
    assert with_exponents('message = f"{100.0 * share:.2g} % of the radius"\nother = f"{plain(1e3)} kN"') != []


OPENERS = frozenset(
    (
        "Of",
        "What",
        "Whether",
        "Which",
        "How",
        "Where",
        "Who",
        "Whose",
        "Why",
        "By",
        "That",
        "Those",
        "When",
        "Its",
        "It",
    )
)
"""Words that begin a clause, not the name of a thing or of what is done."""
LONGEST_SUMMARY = 27
"""Words of a docstring's first sentence: 25 as the style guide says, and two of a formula."""
LONGEST_SENTENCE = 40
"""Words of a sentence of a page: more are read twice."""


def attribute_lines(tree):
    """Yield what is said of constants and fields: the text below an assignment, and entries of sections of a docstring."""
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        for stated, text in pairwise(body if isinstance(body, list) else ()):
            words = getattr(getattr(text, "value", None), "value", None)
            if isinstance(stated, ast.Assign | ast.AnnAssign) and isinstance(text, ast.Expr) and isinstance(words, str):
                yield words.strip()
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            yield from re.findall(r"^\w[\w, *]* : .*\n    (\S.*)", ast.get_docstring(node) or "", re.MULTILINE)


def summaries(tree):
    """Yield the first sentence of each docstring."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            yield re.split(r"\n\s*\n|(?<=\.)\s", ast.get_docstring(node) or "", maxsplit=1)[0]


def opened_by_a_clause(text):
    tree = ast.parse(text)
    return [
        line for line in (*attribute_lines(tree), *summaries(tree)) if (line.split() or [""])[0].strip(",:") in OPENERS
    ]


def word_count(sentence):
    return len(re.findall(r"[A-Za-z][\w'-]*", without_code(sentence)))


def long_sentences(page):
    for paragraph in paragraphs(without_code(page)):
        if not paragraph.lstrip().startswith(("{", "---", "%")):
            for sentence in re.split(r"(?<=[.!?:;])\s+|\n- |\n\d+\. ", paragraph):
                if word_count(re.sub(r"\]\([^)]*\)", "]", sentence)) > LONGEST_SENTENCE:
                    yield " ".join(sentence.split())


@pytest.mark.parametrize("page", [page for page in PAGES if page.name != "CHANGELOG.md"], ids=lambda page: page.name)
def test_sentences_of_pages_are_short(page):
    assert list(long_sentences(page.read_text("utf-8"))) == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_no_line_of_a_page_begins_with_a_percent_sign(page):
    """MyST takes such a line as a comment and drops it."""
    assert re.findall(r"^%.*", page.read_text("utf-8"), re.MULTILINE) == []


def test_the_first_sentence_of_a_docstring_is_short():
    long = [
        line
        for path in MODULES
        for line in summaries(ast.parse(path.read_text("utf-8")))
        if word_count(line) > LONGEST_SUMMARY
    ]
    assert long == []


def test_planted_long_sentences_are_found():
    long = " ".join(["word"] * 41) + "."
    assert list(long_sentences(f"# Page\n\nShort. {long}\n\n- short\n- {long}\n")) == [long, long]
    assert list(long_sentences(f"```\n{long}\n```\n")) == []
    assert max(map(word_count, summaries(ast.parse(f'def f():\n    """{long}"""\n')))) == 41


def test_texts_of_code_begin_with_a_verb_or_the_noun_that_they_describe():
    assert {
        f"{path.relative_to(SOURCE)}: {line}"
        for path in MODULES
        for line in opened_by_a_clause(path.read_text("utf-8"))
    } == set()


def test_a_planted_clause_is_found_in_each_place():
    text = 'A = 1\n"""Of the base, m."""\nclass B:\n    """B.\n\n    Attributes\n    ----------\n    a : int\n        What it is.\n    """\n'
    text += 'def f():\n    """Whether it holds."""\n'
    assert opened_by_a_clause(text) == ["Of the base, m.", "What it is.", "Whether it holds."]
    better = text.replace("Of the", "Mass of the").replace("What it is", "Size").replace("Whether", "Tell whether")
    assert opened_by_a_clause(better) == []
