"""BS09's damper recorded while it heats from 15 to 75 °C, one long file a current."""

from typing import Final

from sysid.rig.bench import Plan
from sysid.rig.lumped_damper import LumpedDamper
from sysid.rig.lumped_run import Heat
from sysid.rig.sweep import Sweep, WarmSetting


def _long_test(current: float, cycles: float) -> WarmSetting:
    """So many steady cycles, at 125 samples each, bring the oil to 75 °C."""
    plan = Plan(rest=0.1, ramp_up=1.5, steady=cycles, ramp_down=1.0)
    return WarmSetting(10e-3, 8.0, current, 15.0, 1000, plan, "heating", wanders=True)


VIRTUAL_BS09_HEATING: Final = Sweep(
    id="virtual-bs09-heating",
    title="Virtual BS09 damper, recorded while heating",
    about=(
        "The damper of virtual-bs09, worked without a pause from 15 to 75 °C: 10 mm 8 Hz at "
        "0.4, 0.6 and 1 A. So that the files stay short, its heat capacity is that of "
        "the oil and the valve alone, and the thermometer sits in the oil."
    ),
    damper=LumpedDamper(),
    settings=(_long_test(0.4, 143.0), _long_test(0.6, 103.0), _long_test(1.0, 80.0)),
    seed=20090103,
    heat=Heat(capacity=100.0, loss=0.3, ambient=22.0, lag=0.1),
)
