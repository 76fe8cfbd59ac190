"""The float64 oracles: what every technique is checked against."""
