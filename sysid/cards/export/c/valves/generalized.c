/* The generalised hysteretic model, v_m the peak velocity, i the current:
 *
 *     F   = C_i (F_t tanh(a (v + v_h + v_b) / 2) - F_b) (1 + k_v |v|)
 *     F_t = F_0 (1 + e^{a_1 v_m}),   a = a_0 / (1 + k_0 v_m)
 *     C_i = 1 + k_2 [s(a_2 (i + I_0)) - s(a_2 I_0)], at least 1, s the logistic function
 *     v_h = sgn(acceleration) k_4 v_m (1 + k_3 [s(a_3 (i + I_1)) - s(a_3 I_1)])
 *     F_b = k_5 C_i F_t,   v_b = k_6 v_m
 *     k_v = k_1c e^{-a_4 v_m} for v >= 0, k_1e e^{-a_4 v_m} below */
static double logistic(double z)
{
    return z >= 0.0 ? 1.0 / (1.0 + exp(-z)) : exp(z) / (1.0 + exp(z));
}

/* s(b + c) - s(c), every digit kept where the two are nearly equal. */
static double logistic_rise(double b, double c)
{
    double start = logistic(c), rest = logistic(-c);
    return start * rest * -expm1(-b) / (start + rest * exp(-b));
}

static double generalized_force(const generalized_parameters *p, const motion *m)
{
    double C_i = fmax(1.0, 1.0 + p->k_2 * logistic_rise(p->a_2 * m->i, p->a_2 * p->I_0));
    double F_t = p->F_0 * (1.0 + exp(p->a_1 * m->v_m));
    double a = p->a_0 / (1.0 + p->k_0 * m->v_m);
    double rise = logistic_rise(p->a_3 * m->i, p->a_3 * p->I_1);
    double v_h = m->side * (p->k_4 * m->v_m * (1.0 + p->k_3 * rise));
    double v_b = p->k_6 * m->v_m;
    double F_b = p->k_5 * C_i * F_t;
    double k_v = (m->v >= 0.0 ? p->k_1c : p->k_1e) * exp(-p->a_4 * m->v_m);
    return C_i * (F_t * tanh(0.5 * a * (m->v + v_h + v_b)) - F_b) * (1.0 + k_v * fabs(m->v));
}

/* Yield part F(i) - F(0 A), viscous part F(0 A). */
static parts generalized_parts(const generalized_parameters *p, const motion *m)
{
    motion idle = *m;
    parts both;
    idle.i = 0.0;
    both.viscous = generalized_force(p, &idle);
    both.yielding = generalized_force(p, m) - both.viscous;
    return both;
}
