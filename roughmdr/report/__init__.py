"""Words, tables and pictures of plans and results."""
