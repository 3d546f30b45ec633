/* Width of the yield part's loop <- width (10 mm / A)^p_w, A the amplitude v_m^2 / |a|. */
static void width_law_yield(const width_law_yield_parameters *p, const motion *m, changes *c)
{
    double amplitude = fmax(m->v_m * m->v_m / fmax(fabs(m->a), 1.0e-6), 1.0e-5);
    c->side_yielding *= pow(0.01 / amplitude, p->p_w);
}
