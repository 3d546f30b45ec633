"""Parity, exponents, contrasts and F ratio against forces whose answer is known."""

from dataclasses import replace

import numpy as np
import pytest

from sysid.data.loops import Loops
from sysid.diagnosis.exponents import exponents
from sysid.diagnosis.iso_velocity import iso_velocity_contrasts
from sysid.diagnosis.lack_of_fit import lack_of_fit
from sysid.diagnosis.parity import PARITIES, parity_shares, split_by_parity
from sysid.diagnosis.where import where_wrong

POINTS = 72
PHASE = 2 * np.pi * np.arange(POINTS) / POINTS
CONDITIONS = [
    (0.0025, 0.5), (0.0125, 0.1), (0.0025, 2.5), (0.0125, 0.5), (0.0025, 5.0), (0.025, 0.5),
    (0.0025, 10.0), (0.05, 0.5), (0.0125, 2.5), (0.0025, 12.5),
]  # fmt: skip


def campaign(force, currents=(0.0, 0.2, 0.4), noise=0.0, cycles=5, seed=0):
    """Loops of force(x, v, a, A, f, i) on exact sinusoids, with white noise on every cycle."""
    grid = np.array([(a, f, i) for a, f in CONDITIONS for i in currents])
    A, f, i = (column[:, None] for column in grid.T)
    w = 2 * np.pi * f
    x, v, a = A * np.sin(PHASE), A * w * np.cos(PHASE), -A * w**2 * np.sin(PHASE)
    true = force(x, v, a, A, f, i) * np.ones_like(x)
    scatter = noise * np.random.default_rng(seed).standard_normal((len(grid), cycles, POINTS))
    mean = scatter.mean(axis=1)
    n = len(grid)
    return Loops(
        ids=tuple(f"{1e3 * a:g}mm_{f:g}Hz_{i:g}A" for a, f, i in grid),
        displacement=x, velocity=v, acceleration=a, force=true + mean,
        amplitude=grid[:, 0], frequency=grid[:, 1], current=grid[:, 2],
        temperature=np.full(n, 40.0), centre=np.zeros(n), cycles=np.full(n, cycles),
        noise_floor=np.full(n, noise if noise else np.nan),
        deviations=tuple(scatter - mean[:, None]),
        displacement_deviations=tuple(np.zeros((cycles, POINTS)) for _ in range(n)),
        harmonics=np.zeros((n, 15), dtype=complex),
    )  # fmt: skip


FORCES = {
    "OD": lambda x, v, a, A, f, i: 100 * np.tanh(v / 0.002) + 500 * v,
    "OC": lambda x, v, a, A, f, i: 2000 * x + 1.5 * a,
    "ED": lambda x, v, a, A, f, i: 3000 * x * np.tanh(v / 0.002),
    "EC": lambda x, v, a, A, f, i: 50 + 1e5 * x**2 + 30 * np.abs(v),
}


@pytest.mark.parametrize("parity", PARITIES)
def test_each_kind_of_force_has_its_parity(parity):
    shares = parity_shares(campaign(FORCES[parity]).force)
    assert shares[parity] == pytest.approx(1.0, abs=1e-9)
    assert sum(shares.values()) == pytest.approx(1.0, abs=1e-12)


def test_parts_add_up_and_are_orthogonal():
    loops = np.random.default_rng(1).standard_normal((4, POINTS))
    parts = list(split_by_parity(loops).values())
    np.testing.assert_allclose(sum(parts), loops, atol=1e-12)
    for k, one in enumerate(parts):
        for other in parts[k + 1 :]:
            assert abs(np.sum(one * other)) < 1e-10


def test_an_odd_number_of_points_is_refused():
    with pytest.raises(ValueError, match="half a cycle"):
        split_by_parity(np.zeros((1, 71)))


def test_shares_of_nothing_are_zero():
    assert set(parity_shares(np.zeros((2, POINTS))).values()) == {0.0}


@pytest.mark.parametrize(
    ("force", "expected"),
    [
        (lambda x, v, a, A, f, i: 1500 * x, (1, 0, 0)),  # gas spring
        (lambda x, v, a, A, f, i: 2.0 * a, (1, 2, 0)),  # inertia
        (lambda x, v, a, A, f, i: 200 * v * np.abs(v), (2, 2, 0)),  # quadratic loss
        (lambda x, v, a, A, f, i: 8.0 + 0 * x, (0, 0, 0)),  # offset
        (lambda x, v, a, A, f, i: 900 * i**0.5 * v, (1, 1, 0.5)),
    ],
)
def test_exponents_are_recovered(force, expected):
    loops = campaign(force)
    size = np.sqrt(np.mean(loops.force**2, axis=1))
    found = exponents(loops, size)
    for exponent, value in zip(found, expected, strict=True):
        assert exponent.value == pytest.approx(value, abs=1e-6), exponent.quantity
        assert exponent.low <= exponent.value <= exponent.high


def test_intervals_of_exponents_cover():
    """95 % intervals with scattered sizes: neither too narrow nor absurdly wide."""
    loops = campaign(FORCES["OC"])
    size = np.sqrt(np.mean(campaign(lambda x, v, a, A, f, i: 1500 * x).force ** 2, axis=1))
    rng, hits, widths = np.random.default_rng(2), 0, []
    for _ in range(400):
        amplitude = exponents(loops, size * np.exp(0.2 * rng.standard_normal(size.size)))[0]
        hits += amplitude.low <= 1.0 <= amplitude.high
        widths.append(amplitude.high - amplitude.low)
    assert 0.92 <= hits / 400 <= 0.98
    assert np.mean(widths) < 0.4


def test_what_the_tests_do_not_vary_has_no_exponent():
    one = campaign(FORCES["OC"]).select(np.array([0, 1, 2]))  # one amplitude, one frequency
    found = exponents(one, np.array([1.0, 2.0, 3.0]))
    assert all(np.isnan(e.value) for e in found[:2])


def test_model_class_of_velocity_shows_no_contrast_and_a_spring_does():
    viscous = campaign(lambda x, v, a, A, f, i: (300 + 900 * i) * np.tanh(v / 0.01), noise=4.0)
    ratios = np.array([c.ratio for c in iso_velocity_contrasts(viscous)])
    assert len(ratios) >= 12
    assert np.median(ratios) == pytest.approx(1.0, abs=0.2)
    assert ratios.max() < 1.6
    off = replace(viscous, current=np.zeros(len(viscous.ids)))
    wander = 1e-5 * np.random.default_rng(1).standard_normal(len(off.ids))
    pairs = [len(iso_velocity_contrasts(z)) for z in (off, replace(off, current=wander))]
    assert pairs[0] == pairs[1] > len(ratios)

    def with_spring(x, v, a, A, f, i):
        return (300 + 900 * i) * np.tanh(v / 0.01) + 3000 * x

    contrasts = iso_velocity_contrasts(campaign(with_spring, noise=4.0))
    worst = contrasts[0]
    assert worst.ratio > 10
    assert worst.parity["OC"] > 0.95
    slow = float(worst.slow.split("mm")[0])
    assert slow > float(worst.fast.split("mm")[0])
    # F_fast − F_slow = k (A_fast − A_slow) sin φ
    fast = float(worst.fast.split("mm")[0])
    assert worst.rms == pytest.approx(3.0 * (slow - fast) / np.sqrt(2), rel=0.1)


def test_f_ratio_is_one_for_the_truth_and_large_for_a_wrong_model():
    truth = campaign(FORCES["OD"])
    loops = campaign(FORCES["OD"], noise=5.0, seed=3)
    right = lack_of_fit(loops, truth.force)
    assert np.mean(right.f_ratio) == pytest.approx(1.0, abs=0.12)
    assert np.mean(right.probability < 0.05) < 0.2
    wrong = lack_of_fit(loops, truth.force + 10.0)
    assert (wrong.f_ratio > 10).all()
    assert wrong.parity["EC"] > 0.8


def test_single_cycles_have_no_ratio():
    loops = campaign(FORCES["OD"], noise=5.0, cycles=1)
    assert np.isnan(lack_of_fit(loops, loops.force).f_ratio).all()


def scattered(loops: Loops, rng: np.random.Generator) -> Loops:
    """As a rig measures: 2 % off in amplitude, 0.2 % in frequency, mA off in current."""
    n = len(loops.ids)
    return replace(
        loops,
        amplitude=loops.amplitude * (1.0 + 0.02 * rng.standard_normal(n)),
        frequency=loops.frequency * (1.0 + 0.002 * rng.standard_normal(n)),
        current=loops.current + 0.002 * rng.standard_normal(n) * (loops.current > 0.0) + 3e-6,
    )


@pytest.mark.parametrize("held", ["amplitude", "frequency", "current"])
def test_one_level_that_scatters_has_no_exponent(held):
    """How an actuator misses the one amplitude is no law of the residual's growth."""
    loops = campaign(FORCES["OD"], currents=(0.2,) if held == "current" else (0.0, 0.2, 0.4))
    if held != "current":
        kept = getattr(loops, held) == {"amplitude": 0.0125, "frequency": 0.5}[held]
        loops = loops.select(kept)
    rng = np.random.default_rng(4)
    size = loops.amplitude * loops.frequency**2 * np.maximum(loops.current, 0.1)
    size = size * np.exp(0.05 * rng.standard_normal(size.size))
    found = {e.quantity: e for e in exponents(scattered(loops, rng), size)}
    assert np.isnan(found[held].value)
    others = {"amplitude": 1.0, "frequency": 2.0, "current": 1.0}
    for quantity, true in others.items():
        if quantity != held:
            assert found[quantity].value == pytest.approx(true, abs=0.25), quantity


def test_amplitude_and_frequency_that_change_together_have_no_exponents():
    """Scatter makes such columns independent, and what it would tell is noise."""
    loops = campaign(FORCES["OD"])
    together = np.isin(loops.amplitude / loops.frequency, [0.0125 / 0.1, 0.0025 / 10.0])
    rng = np.random.default_rng(5)
    loops = scattered(loops.select(together), rng)
    found = exponents(loops, np.exp(rng.standard_normal(len(loops.ids))))
    assert all(np.isnan(e.value) for e in found[:2])


def test_what_a_supply_leaves_at_zero_is_no_current():
    """Microamperes have logarithms too, and they would decide the exponent alone."""
    loops = campaign(FORCES["OD"])
    size = 1.0 + 0.0 * loops.current
    size[loops.current > 0.0] = 100.0 * loops.current[loops.current > 0.0]
    found = {e.quantity: e for e in exponents(scattered(loops, np.random.default_rng(6)), size)}
    assert found["current"].value == pytest.approx(1.0, abs=0.05)


def test_growth_is_told_where_the_error_is_large():
    """Some tenths of a newton at a small stroke grow with frequency, the error that matters not."""
    loops = campaign(FORCES["OD"])
    small = loops.amplitude < 0.01
    size = np.where(small, 0.2 * loops.frequency, 2000.0 * loops.amplitude)
    alike = {e.quantity: e for e in exponents(loops, size)}["frequency"]
    assert alike.value > 0.3, "where every test counts alike, it is said to grow"
    simulated = size[:, None] * np.sign(np.cos(PHASE + 1e-6))
    growth = where_wrong(loops, simulated, np.zeros_like(simulated)).growth
    assert not any(told.startswith("grows") and "frequency" in told for told in growth)
    assert any(told.startswith("grows") and "amplitude" in told for told in growth)
