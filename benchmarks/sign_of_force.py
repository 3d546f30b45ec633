"""Why `asymmetric_gain` has two forms: a load cell turns with the sign of the force.

``python benchmarks/sign_of_force.py`` fits, without any noise, W11's model and the effect, once as
it turns with the sign of the velocity and once with that of the force, to a hidden load cell of
1 %: what gain least squares finds.
"""

from typing import Final, Literal

import jax
import jax.numpy as jnp
import numpy as np
from outcome import Outcome
from scipy.optimize import least_squares

from sysid.effects.channel.asymmetric_gain import AsymmetricGain
from sysid.models.damper import Damper
from sysid.models.generalized import Generalized
from sysid.motion.motion import loop_motion
from sysid.parameters import specs
from sysid.rig.planters.registry import find_planter
from sysid.rig.trial_campaign import Trial, make_trial
from sysid.rig.trial_design import TrialDesign

QUIET: Final = TrialDesign(
    points=72, noise=1e-6, relative_noise=0.0, gain_sd=0.0, offset_sd=0.0, delay_sd=0.0,
    displacement_noise=0.0,
)  # fmt: skip
SEED: Final = 30048


def found(trial: Trial, held: tuple[str, ...], turns: Literal["velocity", "force"]) -> float:
    """The gain by least squares from the truth, some of the base's symbols held."""
    motion, measured = loop_motion(trial.loops), np.asarray(trial.loops.force)
    symbols = [spec.symbol for spec in specs(Generalized)]
    true = np.array([trial.truth.parameters[s] for s in symbols])
    free = np.array([k for k, s in enumerate(symbols) if s not in held])
    scale = np.where(np.abs(true) > 1e-9, np.abs(true), 0.01)[free]

    def residual(u: jax.Array) -> jax.Array:
        p = jnp.asarray(true).at[free].add(u[:-1] * scale)
        valve = Generalized(**dict(zip(symbols, p, strict=True)))
        whole = Damper(valve, (AsymmetricGain(g_a=u[-1], turns=turns),))
        return (whole.force(motion) - measured).ravel()

    value, slope = jax.jit(residual), jax.jit(jax.jacfwd(residual))
    solved = least_squares(
        lambda u: np.asarray(value(u)), np.zeros(free.size + 1), method="lm",
        jac=lambda u: np.asarray(slope(u)), max_nfev=400,  # type: ignore[arg-type]  # stubs know words only
    )  # fmt: skip
    return float(solved.x[-1])


def main() -> None:
    trial = make_trial(SEED, (find_planter("bent_load_cell"),), (1.0,), QUIET)
    (hidden,) = trial.truth.nominal
    outcome = Outcome("sign_of_force", "A load cell that turns with the sign of the force")
    rows = [("hidden", f"{hidden['size']:.4f}")]
    for turns in ("velocity", "force"):
        for name, held in (("symmetric", ("k_5", "k_6")), ("asymmetric", ())):
            gain = found(trial, held, turns)
            outcome.numbers[f"{turns}, {name}"] = gain
            rows.append((f"turning with the {turns}, beside the {name} base", f"{gain:.4f}"))
    outcome.table(("gain g_a", ""), rows)
    outcome.finish()


if __name__ == "__main__":
    main()
