/* F_yield <- F_yield (1 + beta_y (T - 40 degC)). */
static void yield_temperature(const yield_temperature_parameters *p, const motion *m, changes *c)
{
    c->yielding *= 1.0 + p->beta_y * excess_temperature(m);
}
