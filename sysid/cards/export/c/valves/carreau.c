/* F = c v + k x + f_0 + alpha s / (1 + |s|^n)^{1/n},   s = (v - h sgn(acceleration)) / v_0,
 *     c, alpha and h = value at 0 A + rise g(i),  g(i) = 1 - e^{-(|i| / i_s)^m} */
static parts carreau_parts(const carreau_parameters *p, const motion *m)
{
    double g = -expm1(-pow(fmax(fabs(m->i) / p->i_s, 1.0e-12), p->m));
    double s = (m->v - (p->h_a + p->h_b * g) * m->side) / p->v_0;
    double size = sqrt(s * s + 1.0e-12);
    double onset = size < 1.0 ? s * exp(-log1p(pow(size, p->n)) / p->n)
                              : s / size * exp(-log1p(pow(size, -p->n)) / p->n);
    parts both;
    both.yielding = (p->alpha_a + p->alpha_b * g) * onset;
    both.viscous = (p->c_a + p->c_b * g) * m->v + p->k * m->x + p->f_0;
    return both;
}

static double carreau_force(const carreau_parameters *p, const motion *m)
{
    parts both = carreau_parts(p, m);
    return both.yielding + both.viscous;
}
