"""Laws that are made of a finished law of the rough layer."""
