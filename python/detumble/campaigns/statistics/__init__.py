"""What a campaign says: intervals, quantiles, sensitivity, convergence."""
