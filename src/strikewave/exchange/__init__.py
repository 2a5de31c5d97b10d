"""Models and results exchanged with other programs: decks written, results read, in the units of the other program."""
