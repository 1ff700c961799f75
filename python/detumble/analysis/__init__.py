"""What a scenario allows, and which law makes the best of it: bound, tune, compare."""
