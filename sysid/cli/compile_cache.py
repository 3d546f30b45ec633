"""Compiled programs kept between runs, so that a second run of a command starts at once."""

import os
from importlib.metadata import version
from pathlib import Path
from typing import Final

from sysid.cli.console import Talk


def cache_folder() -> Path:
    """``$XDG_CACHE_HOME/sysid/jax``, or ``~/.cache/sysid/jax``."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    root = Path(base) if os.path.isabs(base) else Path(os.path.expanduser("~")) / ".cache"
    return root / "sysid" / "jax"


QUICKLY: Final = "xla_cpu_use_fusion_emitters"
KNOWN: Final = (0, 11)
"""Version of jaxlib before which it is known to have that flag: of one that it does not know, it
dies."""


def keep_compiled(talk: Talk, *, many: bool = False) -> None:
    """Switch JAX's persistent compilation cache on; without a writable place, go on without it.

    Args:
        talk: For a note where there is none.
        many: Many programs will be needed for seconds: they are made so that they compile in 0.6 of
            the time.  What one program does for minutes may take half as long again.  Before
            anything is computed.
    """
    if many:
        _compile_quickly()
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


def _compile_quickly() -> None:
    """Without fusion emitters, unless the user has something to say about them."""
    flags = os.environ.get("XLA_FLAGS", "")
    known = tuple(int(n) for n in version("jaxlib").split(".")[:2]) < KNOWN
    if known and QUICKLY not in flags:
        os.environ["XLA_FLAGS"] = f"{flags} --{QUICKLY}=false".strip()
