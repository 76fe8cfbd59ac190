"""Ways of showing a volume that nobody has seen, chosen from its values: skin, bone, tissue, surface, X-ray ..."""
