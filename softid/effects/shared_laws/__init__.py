"""Laws, and starts of their parameters, that several effects have in common."""
