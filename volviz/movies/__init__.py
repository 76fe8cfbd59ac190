"""Movies in files: frames drawn off-screen one after another, and put together."""
