"""roughmdr warm: compile before the first run."""

import os
from pathlib import Path

import click

from roughmdr.cli.options import FILE, changes_option
from roughmdr.cli.terminal import Command, print_text


@click.command(cls=Command)
@click.argument("scenes", type=FILE, nargs=-1, metavar="[SCENE]...")
@changes_option
@click.option("--workers", type=click.IntRange(min=1), help="Number of processes.  [default: all cores]")
@click.option("--quiet", is_flag=True, help="Print nothing but errors.")
def warm(scenes: tuple[Path, ...], changes: tuple[str, ...], workers: int | None, quiet: bool) -> None:
    """Compile what runs of each SCENE need, so that their first run starts at once.

    Runs one realisation of each cell, along few steps. Without a SCENE it compiles what runs need of all shapes without
    adhesion, under JKR and under Dugdale, which takes minutes.

    Compiled code is looked for in the folders that ROUGHMDR_CACHE names, as PATH does, which may be read-only, and put
    into the first of them that can be written, else into the user's cache folder. A folder can be copied to other
    machines and read by other copies of the same version; a processor of another kind does not find its code there, and
    compiles. Name only folders of people you trust: what is in them is executed.
    """
    from roughmdr.numerics.cache import processor
    from roughmdr.runner.warm import warm as compile_for
    from roughmdr.scene import read

    if changes and not scenes:
        raise click.UsageError("--set needs a SCENE")
    read_scenes = [read(scene, changes) for scene in scenes]
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    warmed = compile_for(read_scenes, workers or cores, quiet=quiet)
    if not quiet:
        print_text(f"compiled     {warmed.compiled} functions, into {click.format_filename(warmed.written)}")
        for folder, count in warmed.found.items():
            print_text(f"found        {count} functions in {click.format_filename(folder)}")
        print_text(f"processor    {processor()}; another kind compiles again")
        print_text(f"time         {warmed.seconds:.1f} s")
