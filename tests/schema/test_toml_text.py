"""The lines of keys in a TOML text, and texts that are no table that can be walked."""

import pytest

from roughmdr.schema.toml_text import key_lines, line_of, parse_toml, unquote_key

TEXT = """title = "a = 1, {b = 2}"  # c = 3
[material]
modulus = 3e6

# [comment]
[asperities]
radius = { distribution = "normal", mean = 1e-5,
"std" = 1e-6 }
height.std = 2e-6
[[asperities.more]]
x = 1
[sweep]
"material.modulus" = [1.0, 2.0]
'path . stop' = 3
[material]
modulus = 4e6
"""
LINES = {
    "title": 1, "material": 2, "material.modulus": 3, "asperities": 6, "asperities.radius": 7,
    "asperities.radius.distribution": 7, "asperities.radius.mean": 7, "asperities.height.std": 9, "sweep": 12,
    "sweep.material.modulus": 13, "sweep.path.stop": 14,
}  # fmt: skip


def test_each_key_has_the_line_where_it_first_stands() -> None:
    """Not what strings and comments hold."""
    lines = key_lines(TEXT)
    assert {key: lines.get(key) for key in LINES} == LINES
    assert not {"comment", "a", "b", "c", "title.b", "title.c"} & lines.keys()


@pytest.mark.parametrize(
    ("key", "line"),
    [
        ("material.modulus", 3),
        ("material.poisson", 2),  # missing: of its table
        ("asperities.radius.mean", 7),
        ("asperities.radius.mode", 7),
        ("asperities.shape", 6),
        ("asperities.height.std[3]", 9),
        ("sweep.material.modulus[1]", 13),
        ("batch.realizations", None),
        ("seed", None),
        ("", None),
    ],
)
def test_a_key_that_is_missing_has_the_line_of_what_is_around_it(key: str, line: int | None) -> None:
    assert line_of(key, key_lines(TEXT)) == line


def test_tables_that_cannot_be_walked_are_refused() -> None:
    """Where they are nested more deeply than any scene, by a little or by far."""
    for depth in (4, 20, 30):
        table = parse_toml(f"a = {'[' * depth}{']' * depth}")
        assert list(table) == ["a"]
    for depth in (40, 200, 100_000):
        with pytest.raises(ValueError, match="nested too deeply"):
            parse_toml(f"a = {'[' * depth}{']' * depth}")
    with pytest.raises(ValueError, match="nested too deeply"):
        parse_toml(f"[{'.'.join('a' * 50)}]")


def test_quotes_and_spaces_are_no_part_of_a_key() -> None:
    assert unquote_key("\"a\" . 'b'.c") == "a.b.c"
