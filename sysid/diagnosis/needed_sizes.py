"""Members of a class that would need a size which no real damper or rig has, in words."""

from collections.abc import Iterable

import jax.numpy as jnp

from sysid.data.loops import Loops
from sysid.diagnosis.coarse import BEYOND, largest
from sysid.diagnosis.contenders import Contender
from sysid.diagnosis.extension import Extended
from sysid.diagnosis.judged import round_of
from sysid.diagnosis.prototypes import magnitudes, size_of
from sysid.diagnosis.words import EFFECT_WORDS, capital, size_words
from sysid.effects.base import AbstractEffect
from sysid.models.coordinates import valve_at
from sysid.parameters import specs


def needed_sizes(best: Extended) -> tuple[str, ...]:
    """Notes on rivals that these tests do not exclude and their size may.

    Args:
        best: The extended base with its verdicts.
    """
    rivals = (
        c
        for kind, one in zip(best.selection.kept, best.verdicts, strict=True)
        if one.status == "class"
        for c in round_of(best.selection, kind).contenders[1:]
        if c.id in one.members
    )
    return tuple(_told(effect, best.base.evidence.loops) for effect in _beyond_any(rivals, best))


def _beyond_any(rivals: Iterable[Contender], best: Extended) -> list[AbstractEffect]:
    own, found = magnitudes(best.base.evidence.loops), {}
    for rival in rivals:
        effect = valve_at(rival.state.coordinates, jnp.asarray(rival.state.u)).effects[-1]
        if abs(size_of(effect)) > largest(effect, own):
            found.setdefault(rival.id, effect)
    return list(found.values())


def _told(effect: AbstractEffect, loops: Loops) -> str:
    facts = effect.facts
    unit = next(s.unit for s in specs(effect) if s.symbol == facts.size)
    needed, most = (
        size_words(facts.size, unit, z)
        for z in (size_of(effect), largest(effect, magnitudes(loops)) / BEYOND)
    )
    return (
        f"{capital(EFFECT_WORDS[facts.id])} would have to be {needed} to explain this; dampers and "
        f"rigs of this size have at most {most}. These tests do not exclude it, what you know of "
        "yours may."
    )
