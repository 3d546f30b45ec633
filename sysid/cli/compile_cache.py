"""Compiled programs kept between runs, so that a second run of a command starts at once."""

import os
from pathlib import Path

from sysid.cli.console import Talk


def cache_folder() -> Path:
    """``$XDG_CACHE_HOME/sysid/jax``, or ``~/.cache/sysid/jax``."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    root = Path(base) if os.path.isabs(base) else Path(os.path.expanduser("~")) / ".cache"
    return root / "sysid" / "jax"


def keep_compiled(talk: Talk) -> None:
    """Switch JAX's persistent compilation cache on; without a writable place, go on without it."""
    folder = cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        writable = os.access(folder, os.W_OK | os.X_OK)
    except OSError:
        writable = False
    if not writable:
        talk.note(f"Compiled programs cannot be kept in {folder}; every run starts cold.")
        return
    import jax

    jax.config.update("jax_compilation_cache_dir", str(folder))
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
    jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)
