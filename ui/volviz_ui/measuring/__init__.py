"""Measuring in the window: the tool that places points, and the list of what was measured."""
