"""One impact by a contact law, the laws side by side, and a law identified from a pulse."""
