"""Compile as fast as possible: these functions run for microseconds."""

import jax

QUICK = {"xla_backend_optimization_level": 0, "xla_cpu_use_fusion_emitters": False}


def quick(function):
    """`jax.jit` with little optimisation."""
    return jax.jit(function, compiler_options=QUICK)
