"""Adhesive asperities coupled in pairs against boundary elements with an attraction of finite range."""
