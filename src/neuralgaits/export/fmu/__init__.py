"""The exported controller as a functional mock-up unit (FMU) for co-simulation, FMI 2.0 or 3.0."""
