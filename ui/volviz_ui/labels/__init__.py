"""The labels of a layer: list, edits, statistics."""
