"""The study of the pull-off of sticky rough surfaces, of which the asperities are independent or feel each other."""
