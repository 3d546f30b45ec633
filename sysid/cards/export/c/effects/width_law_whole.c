/* Width of the loop <- width (10 mm / A)^p_w, A the amplitude v_m^2 / |a| of the motion. */
static void width_law_whole(const width_law_whole_parameters *p, const motion *m, changes *c)
{
    double amplitude = fmax(m->v_m * m->v_m / fmax(fabs(m->a), 1.0e-6), 1.0e-5);
    double share = pow(0.01 / amplitude, p->p_w);
    c->side_yielding *= share;
    c->side_viscous *= share;
}
