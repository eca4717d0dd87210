"""From a JAX function to a Program."""
