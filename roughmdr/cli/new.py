"""roughmdr new: write a scene to start from."""

from pathlib import Path

import click

from roughmdr.cli.options import OUTPUT
from roughmdr.cli.terminal import Command, print_text


@click.command(cls=Command)
@click.argument("scene", type=OUTPUT)
def new(scene: Path) -> None:
    """Write a starter scene to SCENE. It runs as it is; its comments list units and choices.

    Its first line names roughmdr.schema.json to editors, which is written beside it unless it is there already.
    """
    from importlib.resources import files

    from roughmdr.errors import StoreError
    from roughmdr.scene.schema_file import DIRECTIVE, put_beside
    from roughmdr.storage.files import check_ending, check_writable, replace_atomically

    check_writable(scene)
    check_ending(scene, "scene", [".toml"])
    if scene.exists():
        raise StoreError(f"{scene}: exists already; give a new name")
    with replace_atomically(scene) as temporary:
        temporary.write_bytes(DIRECTIVE.encode() + files("roughmdr").joinpath("starter.toml").read_bytes())
    print_text(f"scene        {click.format_filename(scene)}")
    print_text(f"schema       {put_beside(scene)}")
