/* F = c_1 v. */
static double linear_viscosity(const linear_viscosity_parameters *p, const motion *m)
{
    return p->c_1 * m->v;
}
