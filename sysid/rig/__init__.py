"""The virtual laboratory: tests of dampers whose truth is known, written as a rig writes them.

Nothing that fits may import this package, and nothing here imports what fits.
"""
