"""What users see of plans and results: summaries, tables, pictures, and messages on the terminal."""
