"""The `sailenv` command: one module per subcommand, each only arguments and a call."""
