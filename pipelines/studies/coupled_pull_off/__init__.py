"""The study of the pull-off force of asperities that adhere and feel each other."""
