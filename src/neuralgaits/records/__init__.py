"""Results of the verbs as records: their fields, units and files; see `record`. Needs no JAX."""
