"""Kernels under adhesion of finite range (Dugdale, Maugis)."""
