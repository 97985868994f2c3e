"""The tables of the study of adhesive hills."""

import numpy as np
import xarray as xr

from studies.adhesive_hills.judge import judge
from studies.adhesive_hills.measure import ELEMENTS, LONGER, METHODS
from studies.adhesive_hills.stated import report_stated
from studies.study import table


def name_of(case: xr.Dataset) -> str:
    """Return a case in a few words."""
    ratio = f", {float(case['anisotropy']):g}:1" if float(case["anisotropy"]) != 1.0 else ""
    return f"H {float(case['hurst']):g}, 1/{float(case['bandwidth']):g}{ratio}, {float(case['jump_on']):g}"


def report(result: xr.Dataset) -> str:
    """Return errors of each method by case, those of the elements, and where pairs end."""
    rows, ends = [], []
    for i in range(result.sizes["case"]):
        case = result.isel(case=i)
        true = case.sel(source="elements")
        turn = case.sizes["step"] // 2
        ends.append([
            name_of(case),
            f"{100.0 * float(true['contact_fraction'].max()):.1f} %",
            f"{float(-true['force'][turn:].min() / np.abs(true['force']).max()):.2f}",
            f"{float(case['cells']):.1f}",
            f"{100.0 * float(case['lost_from']):.0f} %" if np.isfinite(case["lost_from"]) else "none to 15 %",
        ])  # fmt: skip
        for source in (*METHODS, *ELEMENTS):
            found = judge(case, source)
            errors = [f"{100.0 * value:.0f} %" for value in found[:3]]
            rows.append([name_of(case), source, *errors, f"{found.pull_off:.2f}", f"{found.loss:.2f}"])
    head = ["map, jump-on radius", "source", "loading", "unloading", "area", "pull-off", "loss"]
    ends_head = ["map, jump-on radius", "largest contact", "pull-off over largest force", "zone over grid", "pairs end"]
    return f"""Errors against adhesive boundary elements, r.m.s. from 0.3 % contact on, of the force and the area over
their largest; pull-off force over that of boundary elements; energy lost in the cycle over the pull-off force of
boundary elements times the stretch of a contact, a0²/R. Maps by Hurst exponent, shortest wave over the side, and
jump-on radius a0 over the wavelength. The Tabor number is 2; that of elements with the longer range, on the coarse
grid, which has 2/3 of the points a side, is {2.0 / LONGER:.1f}:

{table(head, rows)}

The largest contact fraction by elements, and the contact fraction of independent hills from which on hills in pairs
have no equilibrium; E* w/strength², which the grid must resolve, over its spacing:

{table(ends_head, ends)}

On how many maps `model_error` of hills in pairs, with the range given, is no less than their error against boundary
elements, both over the largest force and at most 1: maps that its form is from, and maps drawn after it was settled
(Tabor numbers from 1, at most 4, as far as the grid resolves them). Of single steps those count at which the force is
more than 2 % off:

{report_stated(result)}
"""
