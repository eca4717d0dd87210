"""What XLA is told by the environment, which it reads in its own way."""

import os
import subprocess
import sys

import jax
import pytest

from neuralgaits import _quick_jit


def test_xla_reads_every_flag_that_the_tests_set():
    """It reads no further than the first word without a dash, and dies of a flag unknown to it."""
    flags = os.environ["XLA_FLAGS"] + " --xla_no_such_flag=1"
    done = subprocess.run(
        [sys.executable, "-c", "import jax; jax.devices()"],
        env=os.environ | {"XLA_FLAGS": flags},
        capture_output=True,
        text=True,
    )
    assert done.returncode != 0
    assert "--xla_no_such_flag=1" in done.stderr.splitlines()[0]


@pytest.mark.parametrize(
    ("flags", "level"),
    [
        ("", 1),
        ("--xla_cpu_multi_thread_eigen=false", 1),
        ("--xla_backend_optimization_level=3", None),
    ],
)
def test_what_the_environment_says_goes_before_the_package_s_options(monkeypatch, flags, level):
    monkeypatch.setenv("XLA_FLAGS", flags)
    options = _quick_jit._quick()
    assert options.get("xla_backend_optimization_level") == level
    assert ("xla_cpu_use_fusion_emitters" in options) == (jax.__version_info__ < (0, 11))
    assert jax.jit(lambda x: x + 1.0, compiler_options=options)(1.0) == 2.0
