"""The kinds of machines, a module each: `strikewave.analyses.machine.kind` says what each has."""
