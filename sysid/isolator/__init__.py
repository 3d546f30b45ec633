"""Vibration isolators whose damper is a card: plants, controllers, studies of both.

Compression of the damper is positive, and a force is positive when it resists compression, so it
pushes the isolated mass up.
"""
