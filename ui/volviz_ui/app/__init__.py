"""The application: its window, menus and docks."""
