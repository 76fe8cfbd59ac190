"""What is open: documents, sessions, work in the background."""
