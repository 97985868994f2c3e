"""Summaries, tables and pictures of plans and results, and messages on the terminal."""
