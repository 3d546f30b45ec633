"""Hidden effects, each with physics of its own, one a file; `registry` lists them.

A planter must not import the toolkit's effects, models or diagnosis: what it plants would else be
found because both sides share a formula.
"""
