"""One asperity: its contact from each control, its equilibria, and the validity of the theory."""
