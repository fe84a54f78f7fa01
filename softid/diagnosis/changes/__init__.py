"""What changed within a log or between logs."""
