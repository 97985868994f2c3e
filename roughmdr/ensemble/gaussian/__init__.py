"""source = "nayak": the summits of an isotropic Gaussian surface."""
