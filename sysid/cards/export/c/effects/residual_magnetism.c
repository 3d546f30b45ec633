/* i_eff = i + i_r: the core's remanence as current. */
static double residual_magnetism(const residual_magnetism_parameters *p, const motion *m)
{
    return m->i + p->i_r;
}
