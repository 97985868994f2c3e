"""Slow and plain references that only tests need, each independent of what it checks in ``roughmdr``."""
