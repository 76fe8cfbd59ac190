"""Movies in the window: steps, a look ahead, and the film drawn by a process of its own."""
