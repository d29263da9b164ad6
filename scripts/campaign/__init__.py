"""What the campaigns share: logs that are read, changed and written again, runs of the program, and errors against a reference."""
