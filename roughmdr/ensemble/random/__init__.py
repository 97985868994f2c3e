"""source = "random": heights and shape parameters drawn from distributions."""
