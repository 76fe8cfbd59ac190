"""What the techniques that show VTK's own mappers share: images, transfer functions, clipping, settings.

Only `settings` is imported without VTK: techniques are listed far more often than drawn.
"""
