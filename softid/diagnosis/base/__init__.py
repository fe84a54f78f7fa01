"""The model that is extended: its fit, a simpler one, and how the input runs between samples."""
