"""Searches for causes from one beginning or another, and which comes when."""
