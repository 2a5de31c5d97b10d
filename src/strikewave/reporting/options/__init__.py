"""The options of commands: kinds of options, what studies and cases share, and where a result goes."""
