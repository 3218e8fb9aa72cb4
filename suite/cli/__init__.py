"""The command line: one verb a file, options in, exit code out."""
