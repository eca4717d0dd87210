"""The kinds of policy, and the steps that those of exact impacts are made of."""
