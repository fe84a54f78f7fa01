"""Which causes may be named, which cannot be told apart, and the numbers of each."""
