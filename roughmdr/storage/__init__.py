"""Files that appear whole or not at all, and the labelled arrays in them."""
