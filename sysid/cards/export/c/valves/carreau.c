/* F = c v + alpha s / (1 + |s|^n)^{1/n},   s = (v - h sgn(acceleration)) / v_0,
 *     c, alpha and h = value at 0 A + rise g(i),  g(i) = 1 - e^{-(|i| / i_s)^m},
 * and beside it the gas, k x + f_0, which no law and no leak reaches. */
typedef struct {
    double c, alpha, h;
} carreau_loop;

static carreau_loop carreau_loop_of(const carreau_parameters *p, const motion *m)
{
    double g = -expm1(-pow(fmax(fabs(m->i) / p->i_s, 1.0e-12), p->m));
    carreau_loop at = {p->c_a + p->c_b * g, p->alpha_a + p->alpha_b * g, p->h_a + p->h_b * g};
    return at;
}

typedef carreau_loop carreau_loops;

static carreau_loops carreau_loops_of(const carreau_parameters *p, const motion *m)
{
    return carreau_loop_of(p, m);
}

static parts carreau_parts(const carreau_parameters *p, const carreau_loops *at, const motion *m)
{
    double s = (m->v - at->h * m->side) / p->v_0;
    double size = sqrt(s * s + 1.0e-12);
    double onset = size < 1.0 ? s * exp(-log1p(pow(size, p->n)) / p->n)
                              : s / size * exp(-log1p(pow(size, -p->n)) / p->n);
    parts both;
    both.yielding = at->alpha * onset;
    both.viscous = at->c * m->v;
    return both;
}

static double carreau_force(const carreau_parameters *p, const carreau_loop *at, const motion *m)
{
    parts both = carreau_parts(p, at, m);
    return both.yielding + both.viscous;
}

static double carreau_gas(const carreau_parameters *p, const motion *m)
{
    return p->k * m->x + p->f_0;
}
