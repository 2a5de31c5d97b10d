"""Records on the screen: what the command prints of them, a file for each subject."""
