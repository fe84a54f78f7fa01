"""What a diagnosis alone does to its logs: means, even sampling, moving starts, timed jumps."""
