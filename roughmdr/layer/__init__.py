"""Laws that follow from the finished law of a rough layer."""
