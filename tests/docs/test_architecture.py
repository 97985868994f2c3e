"""The page on the architecture names the rooms that there are, and files that are there."""

import re
from pathlib import Path

ROOT = Path(__file__).parent.parent.parent
PACKAGE = ROOT / "roughmdr"
PAGE = (ROOT / "docs" / "architecture.md").read_text()


def test_the_drawing_has_every_room_once() -> None:
    drawn = re.findall(r'class="name">(\w+)<', (ROOT / "docs" / "static" / "rooms.svg").read_text())
    rooms = {path.stem for path in PACKAGE.iterdir() if path.suffix in ("", ".py") and not path.name.startswith("__")}
    assert sorted(drawn) == sorted(rooms)


def test_files_that_it_names_are_there() -> None:
    named = set(re.findall(r"`([\w/.]+(?:\.py|/))`", PAGE))
    assert len(named) > 30
    for name in named:
        assert (ROOT / name).exists() or (PACKAGE / name).exists(), name
