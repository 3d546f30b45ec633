/* F = c v + k x + alpha tanh(beta v - delta sgn(acceleration)) + f_0,
 *     c, alpha and delta = value at 0 A + rise s(i),  s(i) = (1 - e^{-q |i|}) / q */
static double tanh_force(const tanh_parameters *p, const motion *m)
{
    double s = effective_current(m->i, p->q);
    double shift = (p->delta_a + p->delta_b * s) * m->side;
    double yielding = (p->alpha_a + p->alpha_b * s) * tanh(p->beta * m->v - shift);
    return (p->c_a + p->c_b * s) * m->v + p->k * m->x + yielding + p->f_0;
}

/* Yield part F(i) - F(0 A), viscous part F(0 A). */
static parts tanh_parts(const tanh_parameters *p, const motion *m)
{
    motion idle = *m;
    parts both;
    idle.i = 0.0;
    both.viscous = tanh_force(p, &idle);
    both.yielding = tanh_force(p, m) - both.viscous;
    return both;
}
