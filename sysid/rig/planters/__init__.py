"""Hidden effects, each with physics of its own, one a file; empty until there is a diagnosis.

A planter must not import the toolkit's effects, models or diagnosis: what it plants would else be
found because both sides share a formula.
"""
