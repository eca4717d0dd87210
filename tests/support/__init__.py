"""What tests share; benchmarks take from it too."""
