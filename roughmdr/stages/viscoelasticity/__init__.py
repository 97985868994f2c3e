"""Laws of the rough layer that are made of a finished load-separation law."""
