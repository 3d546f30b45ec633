/* k <- k (1 + beta_k (T - 40 degC)), which makes the loop narrower; the factor is at least 0.1. */
static void stiffness_temperature(const stiffness_temperature_parameters *p, const motion *m,
                                  changes *c)
{
    double factor = fmax(1.0 + p->beta_k * excess_temperature(m), 0.1);
    c->stiffness *= factor;
    c->side_yielding /= factor;
    c->side_viscous /= factor;
}
