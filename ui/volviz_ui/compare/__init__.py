"""Several views of one scene: side by side, wiped, blinking, subtracted, measured."""
