"""What the techniques that show VTK's own mappers share: images, transfer functions, clipping, settings.

Only `settings` and `info` may be imported without VTK.
"""
