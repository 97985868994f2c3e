"""A result as a page: complete in itself, well-formed, and the same twice."""

import base64
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command import said
from forms import large
from scenes import ASPERITIES, scene
from tips import Tip

import roughmdr as rm

FEW = {**ASPERITIES, "count": 60}
_VOID = {"meta", "source", "img", "br"}


class Page(HTMLParser):
    """Elements in their order, those that are open, and addresses."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.texts: list[str] = []
        self.images: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in _VOID:
            self.open.append(tag)
        self.images += [value or "" for name, value in attrs if name in ("src", "srcset", "href")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


def written(tmp_path: Path, **changes: Any) -> tuple[Page, str]:
    result, page = tmp_path / "out.nc", tmp_path / "report.html"
    rm.run(scene(**{"asperities": FEW, "batch": {"realizations": 3}} | changes), result)
    assert said("report", result, "-o", page) == f"report       {page}\n"
    text = page.read_text("utf-8")
    return Page(text), text


@pytest.mark.large
@pytest.mark.parametrize(
    "changes",
    [
        {},
        large(
            {
                "sweep": {
                    "adhesion.work": [0.01, 0.02, 0.05],
                    "asperities.height.std": {"linspace": [1e-6, 2e-6], "num": 4},
                }
            }
        ),
        {"output": {"variables": ["force"], "keep": "statistics"}},
        large({"batch": {"estimator": "expected"}}),
        {"path": {"force": {"stop": "0.1 mN", "steps": 12}, "unload": True}},
    ],
    ids=["law", "sweep", "statistics", "expected", "dead load"],
)
def test_a_page_holds_all_of_it_and_needs_no_other_file(tmp_path: Path, changes: dict[str, Any]) -> None:
    page, text = written(tmp_path, **changes)
    assert page.open == []
    told = "".join(page.texts)
    for part in ("A small scene", "How far to trust it", "What was left out", "roughmdr run out.nc -o again.nc"):
        assert part in told
    for part in ("[material]", "seed 7", "@article{", "rounding" if "estimator" not in str(changes) else "integration"):
        assert part in told
    assert page.images
    for image in page.images:
        kind, _, content = image.partition(",")
        assert kind == "data:image/png;base64"
        assert base64.b64decode(content).startswith(b"\x89PNG")
    assert "prefers-color-scheme: dark" in text


@pytest.mark.large
@pytest.mark.parametrize("curves", [1, 2])
def test_a_fit_has_a_page_too(tmp_path: Path, curves: int) -> None:
    tip, free = Tip("hertz", 1e-6, 1e5), ["material.modulus", "offset"]
    measured = [tip.measure(np.random.default_rng(seed), 30, ("constant", 0.01), 0.0) for seed in range(curves)]
    fit, page = tmp_path / "fit.nc", tmp_path / "fit.html"
    rm.fit(measured[0] if curves == 1 else dict(zip("ab", measured, strict=True)), tip.scene(), free, fit)
    said("report", fit, "-o", page)
    text = page.read_text("utf-8")
    read = Page(text)
    assert read.open == []
    assert len(read.images) == 2
    told = "".join(read.texts)
    for part in ("material.modulus", "95 %", "model error", "[asperities]", "Sneddon", "checksum"):
        assert part in told
    assert ("roughmdr run fit.nc -o law.nc" in told) == (curves == 1)
    rm.write_report(fit, page)
    assert page.read_text("utf-8") == text


def test_asperities_have_no_page(tmp_path: Path) -> None:
    with pytest.raises(rm.StoreError, match="holds asperities; a page is of a result or a fit"):
        rm.write_report(rm.generate(FEW, seed=1), tmp_path / "page.html")


@pytest.mark.large
def test_the_same_result_gives_the_same_page_which_is_replaced_and_nothing_else_is(tmp_path: Path) -> None:
    _, first = written(tmp_path)
    rm.write_report(tmp_path / "out.nc", tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text("utf-8") == first
    (tmp_path / "notes.html").write_text("notes")
    for out, says in (("notes.html", "is no html"), ("report.txt", "must end in .html"), ("out.nc", "is an input")):
        with pytest.raises(rm.StoreError, match=says):
            rm.write_report(tmp_path / "out.nc", tmp_path / out)
    rm.write_report(tmp_path / "out.nc", tmp_path / "notes.html", fresh=True)


@pytest.mark.large
def test_nothing_in_a_scene_becomes_a_part_of_the_page(tmp_path: Path) -> None:
    page, text = written(tmp_path, title="<script>alert(1)</script> & <b>bold</b>")
    assert page.open == []
    assert "<script>" not in text
    assert "<b>" not in text


@pytest.mark.skipif(shutil.which("chromium") is None, reason="there is no chromium to look at the page with")
@pytest.mark.parametrize("width", [500, 1280])
def test_a_browser_shows_it_without_a_bar_to_scroll_sideways(tmp_path: Path, width: int) -> None:
    written(tmp_path)
    page = (tmp_path / "report.html").read_text("utf-8")
    probe = "<script>document.title = document.documentElement.scrollWidth + ' ' + innerWidth</script></body>"
    (tmp_path / "probe.html").write_text(page.replace("</body>", probe), "utf-8")
    command = [
        "chromium", "--headless=new", "--no-sandbox", "--disable-gpu", f"--window-size={width},900", "--dump-dom",
        f"file://{tmp_path}/probe.html",
    ]  # fmt: skip
    shown = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120).stdout
    wide, inner = map(int, shown.partition("<title>")[2].partition("</title>")[0].split())
    assert wide <= inner
