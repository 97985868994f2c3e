"""Kernels of any shape that is known by its profile, by Newton's method on its branches."""
