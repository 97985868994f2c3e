"""Parameters of a scene from a measured curve: read, fitted by the expected law, with intervals and doubts."""
