"""One candidate: base model and effects, refitted to all logs and scored on what is held out."""
