"""Numerics that know nothing of contacts: compilation, exact sums, quadrature, checks of arguments."""
