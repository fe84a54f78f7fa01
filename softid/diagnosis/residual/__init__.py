"""What a model leaves: is it more than noise, and what does it follow from."""
