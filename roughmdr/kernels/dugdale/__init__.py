"""Kernels under adhesion with a range (Dugdale, Maugis)."""
