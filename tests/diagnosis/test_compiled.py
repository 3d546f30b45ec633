"""Compiled programs are dropped before they fill the memory maps, and nothing else is."""

import jax
import jax.numpy as jnp
import pytest

from sysid.diagnosis import compiled


@pytest.mark.parametrize(("maps", "dropped"), [(1, True), (-1, False)])
def test_programs_are_dropped_where_they_are_many(maps, dropped, tmp_path, monkeypatch):
    listing = tmp_path / "maps"
    listing.write_text("7f00-7f01 r-xp\n" * (compiled.MOST + maps))
    monkeypatch.setattr(compiled, "MAPS", listing)
    twice = jax.jit(lambda x: 2.0 * x)
    twice(jnp.ones(3))
    assert twice._cache_size() == 1
    assert compiled.make_room() == dropped
    assert twice._cache_size() == (0 if dropped else 1)
    assert float(twice(jnp.ones(3))[0]) == 2.0


def test_where_the_system_does_not_tell_nothing_is_dropped(tmp_path, monkeypatch):
    monkeypatch.setattr(compiled, "MAPS", tmp_path / "none")
    assert not compiled.make_room()
