"""How the documentation is built: `make docs`, without a network, with warnings as errors."""

import sys
from importlib.metadata import version as installed_version
from importlib.resources import files
from pathlib import Path

HERE = Path(__file__).parent
MATHJAX = "tex-svg.js"  # one file, its glyphs within: equations need no network
sys.path.insert(0, str(HERE / "extensions"))

project = "roughmdr"
author = "the developers of roughmdr"
copyright = "the developers of roughmdr, MIT licence"  # noqa: A001 - the name that Sphinx reads
version = release = installed_version("roughmdr")

extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "sphinx_click",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
    "result_reference",
    "scene_reference",
]
exclude_patterns = ["_build", "examples", "extensions", "gallery/**/*.ipynb", "gallery/**/*.py"]
nitpicky = True
default_role = "code"

html_theme = "furo"
html_title = f"roughmdr {release}"
html_static_path = ["static", str(files("sphinx-mathjax-offline") / "static" / "mathjax" / MATHJAX)]
html_css_files = ["style.css"]
html_show_sphinx = False
mathjax_path = MATHJAX

myst_enable_extensions = ["amsmath", "attrs_block", "attrs_inline", "deflist", "dollarmath", "fieldlist"]
myst_heading_anchors = 3

autosummary_generate = True
autodoc_typehints = "none"
numpydoc_show_class_members = False
numpydoc_xref_param_type = False

sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "image_scrapers": ("global_figures",),
    "min_reported_time": 1e9,
    "parallel": 2,
    "remove_config_comments": True,
    "show_memory": False,
    "show_signature": False,
    "write_computation_times": False,
}
