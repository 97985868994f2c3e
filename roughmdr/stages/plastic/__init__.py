"""The law of contacts that yield: kernels of one contact, their sum and mean, and the path of a machine."""
