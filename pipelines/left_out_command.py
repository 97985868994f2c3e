"""One command of roughmdr, for ``left_out.py``.

    python pipelines/left_out_command.py MODULES [ARGUMENTS]...

Imports MODULES, parted by commas, then roughmdr, and does what the ARGUMENTS say; without any that is all. The last
two lines printed are the seconds of processor time and the bytes taken at most, and the modules loaded. It imports
nothing else, since that is counted.
"""

import sys
import time
from importlib import import_module

from studies.peak import peak


def main(modules: str, *arguments: str) -> None:
    """Import, carry out, print."""
    for name in filter(None, modules.split(",")):
        import_module(name)
    import_module("roughmdr")
    if arguments:
        from roughmdr.cli import main as command

        command(list(arguments), prog_name="roughmdr", standalone_mode=False)
    print(time.process_time(), peak())
    print(*sys.modules)


if __name__ == "__main__":
    main(*sys.argv[1:])
