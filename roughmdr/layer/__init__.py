"""Laws of the rough layer that are made of a finished law of it."""
