"""Whether what a base leaves is small enough for a covariance to hold its parameters."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from sysid.data.loops import Loops
from sysid.diagnosis import diagnose
from sysid.diagnosis import far_off as module
from sysid.diagnosis.bases import Base, fit_bases
from sysid.diagnosis.coarse import COARSE
from sysid.diagnosis.extension import Extended
from sysid.diagnosis.far_off import far_off
from sysid.identification.result import Fit
from sysid.rig.trial_campaign import make_trial
from tests.data.shipped import shipped_loops
from tests.diagnosis.bare import bare
from tests.diagnosis.diagnosed import DESIGN


def base_of(loops: Loops, model: str, variant: str | None = None) -> Base:
    return fit_bases(loops, ((model, variant),), seed=0, progress=lambda _: None)[0]


def error_of(base: Base) -> float:
    """In free run, the preload counted, as a damper that has none errs by it."""
    return float(base.held_out.mean())


@pytest.fixture(scope="module")
def sweep() -> Base:
    """A preload that the lumped model lacks, beside laws that are wrong.

    Tests as those of tests/cli/test_fit_sweep.py: what is compiled for one serves the other.
    """
    loops = shipped_loops("virtual-sweep")
    wanted = product(("10mm_8Hz", "5mm_4Hz"), ("0A", "0.4A", "1A"), ("15C", "35C", "55C", "75C"))
    places = [loops.ids.index("_".join(parts)) for parts in wanted]
    return base_of(loops.select(np.array(places)), "lumped")


def test_a_fit_that_sigma_does_not_hold_is_far_off(sweep):
    assert sweep.in_sample < 0.5 * COARSE, "by its shapes alone it would not be"
    assert error_of(sweep) > 2.0 * COARSE
    assert far_off(sweep)


def test_a_preload_alone_is_nothing_to_be_far_off_by():
    """Under Σ the laws of a base that is right stay where they are, whatever preload it lacks."""
    loops = make_trial(71, (), (), DESIGN).loops
    preload = 0.2 * np.abs(loops.force).max(axis=1).mean()
    base = base_of(replace(loops, force=loops.force + preload), "generalized", "symmetric")
    assert error_of(base) > 2.0 * COARSE
    assert not far_off(base)


@pytest.mark.parametrize(("error", "astray", "far"), [(0.03, True, False), (0.21, False, False)])
def test_sigma_is_asked_only_where_much_is_missing(error, astray, far, monkeypatch):
    asked = []
    monkeypatch.setattr(module, "_whole", lambda _: error)
    monkeypatch.setattr(module, "_astray", lambda base: asked.append(base) or astray)
    assert far_off(bare(Base, in_sample=0.03)) is far
    assert bool(asked) is (error > COARSE)


def test_laws_that_are_wrong_by_a_tenth_are_far_off_whatever_sigma_says(monkeypatch):
    monkeypatch.setattr(module, "_astray", lambda _: pytest.fail("nobody need ask"))
    assert far_off(bare(Base, in_sample=0.1))


@pytest.mark.parametrize("far", [False, True])
def test_a_diagnosis_goes_the_way_that_it_is_told(far, monkeypatch):
    """Far off one base is extended, without Σ."""
    loops, gone = make_trial(71, (), (), DESIGN).loops, []
    bases = tuple(
        bare(Base, fit=bare(Fit, model=m), in_sample=0.03, shapes=np.full(3, 0.03))
        for m in ("tanh", "generalized")
    )

    class EnoughError(Exception):
        """Enough was seen."""

    def extend(base, *_, coarse):
        gone.append((base.fit.model, coarse))
        if far or len(gone) == 2:
            raise EnoughError
        return bare(Extended, base=bare(Base, held_out=np.full(3, 0.03)), gain=None)

    monkeypatch.setattr(diagnose, "_fit", lambda *_: bases)
    monkeypatch.setattr(diagnose, "at_odds", lambda *_: None)
    monkeypatch.setattr(diagnose, "take_out", lambda *_: (None, None))
    monkeypatch.setattr(diagnose, "with_error_models", lambda some: some)
    monkeypatch.setattr(diagnose, "far_off", lambda base: far if base is bases[0] else None)
    monkeypatch.setattr(diagnose, "extend", extend)
    with pytest.raises(EnoughError):
        diagnose.diagnose_loops(loops)
    assert [way for _, way in gone] == [far] * (1 if far else 2)
