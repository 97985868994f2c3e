"""Studies of the errors and limits of ``roughmdr``, and the framework that runs them."""
