"""source = "spectrum": maps of periodic Gaussian surfaces, and the hills or summits of them."""
