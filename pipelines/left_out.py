"""What leaving out saves: time, memory and work of scenes with each part that they do not need forced on.

    python pipelines/left_out.py -o results/studies

Each part is forced on alone, and the forces are compared. Writes left_out.nc and left_out.png. Needs /proc.
"""

import xarray as xr
from left_out_measured import IMPORTS, REDUCED, all_rows
from left_out_picture import draw, figures
from studies.study import Study, named, table

OF = ("left out", "forced on")


def measure(quick: bool) -> xr.Dataset:
    """All figures, one case for each scene and part."""
    rows = all_rows(quick)
    both = ("case", "of")
    return xr.Dataset(
        {
            "seconds": (both, [row.seconds for row in rows], named("processor time", "s")),
            "memory": (both, [row.bytes for row in rows], named("memory at most", "byte")),
            "counted": (both, [row.counted for row in rows], named("what is counted")),
            "difference": ("case", [row.difference for row in rows], named("of the forces, over the largest")),
            "stated": ("case", [row.stated for row in rows], named("difference that the stated errors allow")),
        },
        {
            "of": list(OF),
            "scene": ("case", [row.scene for row in rows]),
            "part": ("case", [row.part for row in rows]),
            "unit": ("case", [row.unit for row in rows], named("what is counted")),
        },
        {"comment": f"Here scenes are {REDUCED} times smaller than they are called." if quick else ""},
    )


def tell(result: xr.Dataset) -> str:
    """The table, and how far the forces are apart."""
    head = ["part", "in", "processor time [ms]", "times", "memory [MB]", "work"]
    ranged = result["part"] == "range of adhesion"
    exact, other = result.where(~ranged, drop=True), result.where(ranged, drop=True)
    return f"""
From what a part costs left out to what it costs forced on, each alone. The memory of scenes is on top of what the
process has when all is compiled, that of commands is all of it. A scene is timed anew for each part: with the part left
out, always the same, it took up to {_unrest(result):.2f} times as long as at best. {result.attrs["comment"]}

{table(head, [_line(result.isel(case=case)) for case in range(result.sizes["case"])])}

Forced on or left out, the forces are the same to {float(exact["difference"].max()):.1g} of the largest; by the errors
that are stated of them they may differ by {float(exact["stated"].min()):.1g} and more. JKR in place of the law with a
range is off by {float(other["difference"].max()):.1g}, of the 0.01 that the scene allows.
"""


def _unrest(result: xr.Dataset) -> float:
    """How much longer than at best a scene took with a part left out, whichever; the most of all scenes."""
    plain = result["seconds"].sel(of="left out").where(result["part"] != IMPORTS, drop=True).groupby("scene")
    return float((plain.max() / plain.min()).max())


def _line(case: xr.Dataset) -> list[str]:
    seconds, memory, counted = (case[name].to_numpy() for name in ("seconds", "memory", "counted"))
    return [
        str(case["part"].values),
        str(case["scene"].values),
        " to ".join(figures(1e3 * own) for own in seconds),
        figures(seconds[1] / seconds[0]),
        " to ".join(f"{1e-6 * own:.1f}" for own in memory),
        f"{' to '.join(map(figures, counted))} {case['unit'].values}",
    ]


STUDY = Study("left_out", "What leaving out saves", measure, draw, tell)

if __name__ == "__main__":
    STUDY.command()
