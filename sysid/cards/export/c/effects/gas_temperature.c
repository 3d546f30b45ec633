/* F = c_gT (T - 40 degC): the gas preload grows with temperature. */
static double gas_temperature(const gas_temperature_parameters *p, const motion *m)
{
    return p->c_gT * excess_temperature(m);
}
