"""The panels in the docks around the viewport."""
