"""The commands, one a file. Modules that take long to import are imported inside them, so that the other commands start fast."""
