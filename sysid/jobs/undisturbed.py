"""Loaded by workers of our own: Ctrl-C is for whoever gives them work, and ends them in order."""

import signal


def dask_setup(worker: object) -> None:
    """Called by Dask when a worker starts."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
