"""Every command of the program, defined once: a file for each menu, whose `menu()` is the table of its commands."""
