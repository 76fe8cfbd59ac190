"""Movies as values: steps in time, and what a scene is at any moment of them."""
