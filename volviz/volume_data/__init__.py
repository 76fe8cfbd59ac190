"""Volumes as data: where they come from, what a source can be asked, and keys for what is derived from them."""
