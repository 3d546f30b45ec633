"""Damper models: force from motion, current and temperature."""
