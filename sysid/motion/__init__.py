"""What a damper is subjected to, on one cycle or on any time grid.

Importing this package switches JAX to float64, on which every tolerance of the program rests.
"""

import jax

jax.config.update("jax_enable_x64", True)
