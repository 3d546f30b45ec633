"""The differential equation: how the parts of the damper act on each other.

The unknowns of a test are thirteen, in units in which all are about as large. The flow through the
valve is not one of them: friction under the poles gives the flow as an explicit function of the
drop of pressure there, and its inverse has no closed form. So the drop is the unknown, and what is
integrated is the flow that follows from it.

Shapes: all arrays are of one shape, […], a number for each of the tests side by side, or [13, …].
"""

from typing import Final, NamedTuple

import jax.numpy as jnp
from jax import Array

from sysid.rig.physical.damper import PhysicalDamper
from sysid.rig.physical.gas import ATMOSPHERE

MEGA: Final = 1e6
"""Pa; unit of pressures in the unknowns."""
SCALES: Final = (1e-3, 1e-3, 0.1, 1.0, 1.0, MEGA, 1.0, 1e-5, 1e-5, 10.0, 1e-2, 10.0, 10.0)
"""Unit of each unknown: m, m, m/s, 1, 1, Pa, 1, m, m, K, 1, K, K."""
COUNT: Final = len(SCALES)


class State(NamedTuple):
    """The unknowns, SI and °C.

    Attributes:
        ram: Position of the ram without load, m.
        piston: Displacement of the piston, m; compression positive.
        speed: Of the piston, m/s.
        far: ln of the absolute pressure in the chamber without rod over 1 MPa.
        near: The same in the rod's chamber.
        drop: Of pressure by friction under the poles, Pa.
        gas: ln of the gas's volume over that at mid-stroke and 20 °C.
        floating_bend: Of the bristles of the floating piston's seal, m.
        bend: Of the rod seal's, m.
        gas_temperature: °C.
        foam: Free gas in the rod's chamber besides what is always there.
        oil: °C.
        body: °C.
    """

    ram: Array
    piston: Array
    speed: Array
    far: Array
    near: Array
    drop: Array
    gas: Array
    floating_bend: Array
    bend: Array
    gas_temperature: Array
    foam: Array
    oil: Array
    body: Array


class Drive(NamedTuple):
    """What is done to the damper at a moment.

    Attributes:
        command: Displacement asked of the actuator, m.
        speed: Its rate, m/s.
        yield_stress: Of the fluid under the poles at 40 °C, Pa.
        coil_power: Heat of the coil, W.
    """

    command: Array
    speed: Array
    yield_stress: Array
    coil_power: Array


class Seen(NamedTuple):
    """What follows from a state: forces N, pressures Pa, powers W.

    Attributes:
        force: Of the damper on the load cell, which holds the body, N.
        ram: Position of the ram under load, m.
        flow: Through the valve, m³/s, out of the chamber without rod.
        pressures: Absolute, of the two chambers and the gas.
        heat: Set free in the damper by friction, W.
        friction: Of the rod's seal, N.
        oil: °C.
        body: °C.
        gas_heat: Power that passes from the gas to the body, W.
    """

    force: Array
    ram: Array
    flow: Array
    pressures: tuple[Array, Array, Array]
    heat: Array
    friction: Array
    oil: Array
    body: Array
    gas_heat: Array


def unpack(y: Array) -> State:
    """Unknowns in SI from [13, …] in their units."""
    return State(*(row * unit for row, unit in zip(y, SCALES, strict=True)))


def pack(state: State) -> Array:
    """[13, …] in their units."""
    return jnp.stack([row / unit for row, unit in zip(state, SCALES, strict=True)])


def balance(damper: PhysicalDamper, y: Array, drive: Drive) -> tuple[Array, Array, Seen]:
    """What is integrated, U(y), and its rate, both [13, …], with dU/dt = rate.

    U is y itself but for the drop of pressure, in whose place stands the inertance times the flow.

    Args:
        damper: All constants.
        y: Unknowns in their units.
        drive: What is done.

    Returns:
        U, its rate, and what can be seen.
    """
    s = unpack(y)
    shape, oil, gas, heat = damper.cylinder, damper.oil, damper.gas, damper.heat
    v, x = s.speed, s.piston
    far, near = MEGA * jnp.exp(s.far), MEGA * jnp.exp(s.near)
    volume = gas.volume * jnp.exp(s.gas)

    # mounts and actuator
    spring = damper.rig.spring(s.ram, x)
    ram = damper.rig.ram(s.ram, spring)
    ram_rate = damper.rig.servo_rate(ram, drive.command, drive.speed)
    through = damper.rig.force(spring, ram_rate - v)

    # floating piston: without mass, it goes where its friction lets it
    p_gas = gas.pressure(volume, s.gas_temperature)
    pushed = (far - p_gas) * shape.bore
    back, floating_bending = damper.floating.driven_by(pushed, s.floating_bend)
    gas_rate = -shape.bore * back
    warming = gas.warming(volume, gas_rate, s.gas_temperature, s.body)

    # valve
    tau_y = oil.yielding(drive.yield_stress, s.oil)
    flow = damper.valve.flow(s.drop, oil, tau_y, s.oil)
    drop = s.drop + damper.valve.rest_of_drop(flow, oil, s.oil)
    inertance = damper.valve.inertance(oil)

    # seal of the rod, and the piston
    friction, bending = damper.seal.sliding_at(v, s.bend, near - ATMOSPHERE)
    fluid = far * shape.bore - near * (shape.bore - shape.rod) - ATMOSPHERE * shape.rod
    force = fluid + friction
    acceleration = (through - force) / shape.mass

    # heat
    floating_heat = pushed * back - damper.floating.stiffness * (s.floating_bend * floating_bending)
    seal_heat = friction * v - damper.seal.stiffness * s.bend * bending
    set_free = flow * drop + seal_heat + floating_heat
    oil_rate, body_rate = heat.rates(set_free + drive.coil_power, s.oil, s.body)
    gas_heat = gas.heat_capacity() * (s.gas_temperature - s.body) / gas.heat_time
    body_rate = body_rate + gas_heat / heat.body

    # chambers
    far_volume = shape.far - shape.bore * x + (gas.volume - volume)
    near_volume = shape.near + (shape.bore - shape.rod) * x
    foaming = damper.mixing.rate(s.foam, damper.valve.jet(flow), near)
    far_squeeze = shape.bore * v - flow + gas_rate + oil.expansion * far_volume * oil_rate
    near_squeeze = (
        flow
        - (shape.bore - shape.rod) * v
        + near_volume * (foaming * ATMOSPHERE / near + oil.expansion * oil_rate)
    )
    far_rate = far_squeeze / (far_volume * oil.compressibility(far, 0.0 * far) * far)
    near_rate = near_squeeze / (near_volume * oil.compressibility(near, s.foam) * near)

    rate = State(
        ram_rate, v, acceleration, far_rate, near_rate, far - near - drop,
        gas_rate / volume, floating_bending, bending, warming, foaming, oil_rate, body_rate,
    )  # fmt: skip
    integrated = s._replace(drop=inertance * flow)
    pressures = (far, near, p_gas)
    seen = Seen(force, ram, flow, pressures, set_free, friction, s.oil, s.body, gas_heat)
    return pack(integrated), pack(rate), seen


def at_rest(damper: PhysicalDamper, centre: Array, oil: Array, body: Array) -> Array:
    """[13, …] where nothing moves: no friction, all pressures that of the gas.

    Args:
        damper: All constants.
        centre: Position of the ram, m; the piston stays behind by what bends and by half the play.
        oil: °C.
        body: And of the gas, °C.
    """
    shape, gas, rig = damper.cylinder, damper.gas, damper.rig
    wet = shape.far + shape.near

    def still(piston: Array) -> tuple[Array, Array, Array]:
        """Gas volume, pressure, force."""
        grown = damper.oil.expansion * (wet - shape.rod * piston) * (oil - 20.0)
        volume = gas.volume - shape.rod * piston - grown
        pressure = gas.pressure(volume, body)
        return volume, pressure, (pressure - ATMOSPHERE) * shape.rod

    piston = centre
    for _ in range(3):  # the pressure hardly depends on where the piston is
        piston = centre - still(piston)[2] / rig.mount - 0.5 * rig.play
    volume, pressure, force = still(piston)
    none = jnp.zeros_like(pressure)
    level = jnp.log(pressure / MEGA)
    return pack(
        State(
            centre + force / rig.column,
            piston,
            none,
            level,
            level,
            none,
            jnp.log(volume / gas.volume),
            none,
            none,
            body + none,
            none,
            oil + none,
            body + none,
        )
    )
