"""source = "random": heights and shape parameters drawn from distributions.

``distribution_families`` declares the distributions, ``distribution`` draws from one, ``distribution_reader`` reads one
from a scene; ``population`` joins those of the height and the shape parameters, draws from them and has nodes to
integrate over them; ``section`` declares the keys of a scene.
"""
