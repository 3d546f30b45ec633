/* F = c v + alpha tanh(beta v - delta sgn(acceleration)),
 *     c, alpha and delta = value at 0 A + rise s(i),  s(i) = (1 - e^{-q |i|}) / q,
 * and beside it the gas, k x + f_0, which no law and no leak reaches. */
typedef struct {
    double c, alpha, delta;
} tanh_loop;

static tanh_loop tanh_at(const tanh_parameters *p, double i)
{
    double s = effective_current(i, p->q);
    tanh_loop at = {p->c_a + p->c_b * s, p->alpha_a + p->alpha_b * s, p->delta_a + p->delta_b * s};
    return at;
}

static tanh_loop tanh_loop_of(const tanh_parameters *p, const motion *m)
{
    return tanh_at(p, m->i);
}

static double tanh_force(const tanh_parameters *p, const tanh_loop *at, const motion *m)
{
    double yielding = at->alpha * tanh(p->beta * m->v - at->delta * m->side);
    return at->c * m->v + yielding;
}

static double tanh_gas(const tanh_parameters *p, const motion *m)
{
    return p->k * m->x + p->f_0;
}

typedef struct {
    tanh_loop driven, idle; /* at this current, at 0 A */
} tanh_loops;

static tanh_loops tanh_loops_of(const tanh_parameters *p, const motion *m)
{
    tanh_loops both = {tanh_at(p, m->i), tanh_at(p, 0.0)};
    return both;
}

/* Yield part F(i) - F(0 A), viscous part F(0 A). */
static parts tanh_parts(const tanh_parameters *p, const tanh_loops *at, const motion *m)
{
    parts both;
    both.viscous = tanh_force(p, &at->idle, m);
    both.yielding = tanh_force(p, &at->driven, m) - both.viscous;
    return both;
}
