"""The commands of ``volviz``, one file for each kind."""
