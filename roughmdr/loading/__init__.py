"""The path of the flat and the memory that adhesive contacts keep of it."""
