"""The search for causes: screening, racing, and the chain that grows, swaps and shrinks."""
