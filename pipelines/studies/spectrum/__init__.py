"""Surfaces of one spectrum as summits by Nayak, as summits and hills of maps, and by boundary elements."""
