"""The command line: reads arguments, calls one workflow, prints, exits. It holds no logic."""
