"""Pressure, displacement and stress of one contact."""
