"""source = "surface": the summits of a measured height map."""
