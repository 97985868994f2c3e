"""The mean law of a result as a table for finite-element codes, and the expected law as quadrature nodes."""
