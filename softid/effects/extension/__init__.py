"""A model with effects as one model: what moves it, and how it is simulated with derivatives."""
