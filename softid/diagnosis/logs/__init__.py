"""What is done to the logs before the search: noise and gaps of the input, decimation, a set."""
