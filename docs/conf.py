"""The site: `make docs`. Pages are the Markdown files beside this one; notebooks are those of `strikewave examples`.

What is built asks no other host for anything: equations are MathML, fonts those of the reader.
"""

import os
import re
import shutil
import sys
from pathlib import Path

import strikewave
from strikewave.cli.program_commands import EXAMPLES as PACKAGED
from strikewave.cli.program_commands import copy_examples

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_extensions"))
EXAMPLES = HERE / "examples"
"""What `strikewave examples` copies, made anew: the notebooks of the site are those of the package."""

shutil.rmtree(EXAMPLES, ignore_errors=True)
copy_examples(EXAMPLES)
for notebook in EXAMPLES.glob("notebooks/*.ipynb"):  # as old as the package's, so that the next builder runs none again
    shutil.copystat(PACKAGED / "notebooks" / notebook.name, notebook)

project = "strikewave"
author = project_copyright = "The strikewave founders"
version = release = strikewave.__version__
extensions = [
    *("myst_nb", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "sphinx.ext.napoleon"),
    *("docstrings", "case_inputs", "json_keys", "mathml"),
]
templates_path = ["_templates"]
default_role = "py:obj"  # a name in single quotes of a docstring leads to it, where the reference has it
exclude_patterns = ["_build", "examples/cases", "examples/records"]
suppress_warnings = ["misc.highlighting_failure"]  # consoles and sketches are shown as they are

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
# a page that runs `!strikewave` runs this one, as a reader's shell does
os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
if shutil.which("strikewave") is None:  # a cell whose shell finds no program would only show that
    raise FileNotFoundError(f"strikewave is not installed beside {sys.executable}")
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True

autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_type_aliases = {"ArrayLike": "ArrayLike", "Array": "ndarray"}  # else a signature has their many lines
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 100  # a longer signature has a line for each parameter
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_preprocess_types = True
napoleon_use_ivar = True
LISTED = re.findall(
    r"^(?:   |.. autoclass:: )(strikewave\.[\w.]+\.[A-Z]\w+)$", (HERE / "reference.md").read_text("utf-8"), re.M
)
napoleon_type_aliases = {name.rpartition(".")[2]: f":py:obj:`~{name}`" for name in LISTED}  # by which types lead there
math_numfig = True
math_eqref_format = "({number})"

man_pages = [("commands", "strikewave", "predict, measure and design high-g impact tests", author, 1)]

html_theme = "furo"
html_math_renderer = "mathml"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_title = "strikewave"
html_show_sphinx = False
html_copy_source = False
