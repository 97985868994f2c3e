"""Kernels in closed form: power laws and the flat punch, with and without adhesion."""
