"""Measured radial profiles: a spline, its MDR profile in pieces, and their lookup."""
