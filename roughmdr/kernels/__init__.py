"""Kernels of one asperity: jitted scalars, floats in and floats out; ``choose`` returns those of a shape."""
