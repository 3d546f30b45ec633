"""Cards as programs for other people's simulators: C99, FMU, Modelica, look-up tables."""
