"""How programs are compiled: quickly where many are needed, as the user says in any case."""

import os

import pytest

from sysid.cli.compile_cache import QUICKLY, keep_compiled
from sysid.cli.console import Talk


@pytest.mark.parametrize(
    ("given", "many", "then"),
    [
        ("", False, ""),
        ("", True, f"--{QUICKLY}=false"),
        ("--xla_dump_to=d", True, f"--xla_dump_to=d --{QUICKLY}=false"),
        (f"--{QUICKLY}=true", True, f"--{QUICKLY}=true"),
    ],
)
def test_what_is_needed_for_seconds_compiles_quickly(given, many, then, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("XLA_FLAGS", given)
    keep_compiled(Talk(quiet=True), many=many)
    assert os.environ["XLA_FLAGS"] == then


def test_a_flag_that_may_be_unknown_is_not_given(monkeypatch, tmp_path):
    """jaxlib ends the process on one that it does not know."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("XLA_FLAGS", "")
    monkeypatch.setattr("sysid.cli.compile_cache.version", lambda name: "0.11.2")
    keep_compiled(Talk(quiet=True), many=True)
    assert os.environ["XLA_FLAGS"] == ""
