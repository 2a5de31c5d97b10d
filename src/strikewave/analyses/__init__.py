"""One folder an analysis: build, run, result, notices, figures, report, command."""
