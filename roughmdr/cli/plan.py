"""roughmdr plan: tell what a run will do."""

from pathlib import Path

import click

from roughmdr.cli.options import FILE, changes_option, json_option, workers_option
from roughmdr.cli.terminal import Command, print_document, print_text


@click.command(cls=Command)
@click.argument("scene", type=FILE)
@changes_option
@workers_option
@json_option
@click.pass_context
def plan(ctx: click.Context, scene: Path, changes: tuple[str, ...], workers: int, as_json: bool) -> None:
    """Tell what a run of SCENE will do.

    Prints the number of runs and tasks, time and memory, and what is left out and why. Nothing is computed.
    """
    from roughmdr.report.plan import describe_plan, plan_table
    from roughmdr.scene import read

    validated = read(scene, changes)
    from roughmdr.batch.choose import plan_scene
    from roughmdr.batch.estimate import estimate
    from roughmdr.batch.foresee import foresee_cells

    planned = plan_scene(validated)
    cost, prospect = estimate(planned, workers), foresee_cells(planned)
    if as_json:
        print_document(ctx, plan=plan_table(planned, cost, prospect, workers))
    else:
        print_text(describe_plan(planned, cost, prospect, workers))
