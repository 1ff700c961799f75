"""What a scenario allows: bounds that no controller can beat."""
