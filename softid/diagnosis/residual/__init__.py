"""What a model leaves: is it more than noise, what does it follow from, when does it begin."""
