"""The comparison: experiments, trials, verdicts, tables and the command line."""
