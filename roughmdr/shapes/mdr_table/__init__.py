"""The shape that is given by its MDR profile: its functions, the numbers that they read, and the shape itself."""
