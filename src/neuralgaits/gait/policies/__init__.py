"""The kinds of policy, and the parts of steps with exact impacts."""
