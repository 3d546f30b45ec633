/* F_visc <- F_visc exp(beta_v (T - 40 degC)). */
static void viscosity_temperature(const viscosity_temperature_parameters *p, const motion *m,
                                  changes *c)
{
    c->viscous *= exp(p->beta_v * excess_temperature(m));
}
