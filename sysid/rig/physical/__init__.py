"""A magnetorheological damper as a differential equation, apart from every model that is fitted."""

import jax

jax.config.update("jax_enable_x64", True)
