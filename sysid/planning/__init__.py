"""Which test to run next, to settle what a diagnosis left open."""
