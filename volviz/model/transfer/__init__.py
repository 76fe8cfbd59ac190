"""Transfer functions: values, edits, presets, files of other programs."""
