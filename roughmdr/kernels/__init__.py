"""One asperity: jitted scalars, floats in and floats out, and the laws that bundle them."""
