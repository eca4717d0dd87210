"""Branch and bound over boxes of the chart."""
