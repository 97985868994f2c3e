"""What follows from the finished law of a rough layer."""
