/* F = K_hb v (v^2 + v_0^2)^((n_hb - 1)/2), v_0 = 1 mm/s: a power law of speed. */
static double shear_thinning(const shear_thinning_parameters *p, const motion *m)
{
    return p->K_hb * m->v * pow(m->v * m->v + 1.0e-6, 0.5 * (p->n_hb - 1.0));
}
