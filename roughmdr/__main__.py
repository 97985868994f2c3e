"""``python -m roughmdr``: the command line."""

from roughmdr.cli import main

main(prog_name="roughmdr")
