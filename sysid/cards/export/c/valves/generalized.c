/* The generalised hysteretic model, v_m the peak velocity, i the current:
 *
 *     F   = C_i (F_t tanh(a (v + v_h + v_b) / 2) - F_b) (1 + k_v |v|)
 *     F_t = F_0 (1 + e^{a_1 v_m}),   a = a_0 / (1 + k_0 v_m)
 *     C_i = 1 + k_2 [s(a_2 (i + I_0)) - s(a_2 I_0)], at least 1, s the logistic function
 *     v_h = sgn(acceleration) k_4 v_m (1 + k_3 [s(a_3 (i + I_1)) - s(a_3 I_1)])
 *     F_b = k_5 C_i F_t,   v_b = k_6 v_m
 *     k_v = k_1c e^{-a_4 v_m} for v >= 0, k_1e e^{-a_4 v_m} below */
typedef struct {
    double C_i, F_t, F_b, a, v_h, v_b, decay; /* v_h of the side 1, decay = e^{-a_4 v_m} */
} generalized_loop;

/* s(b + c) - s(c), every digit kept where the two are nearly equal. */
static double logistic_rise(double b, double c)
{
    double small = exp(-fabs(c)), fall = expm1(-b);
    double near = 1.0 / (1.0 + small), far = small * near;
    double start = c >= 0.0 ? near : far, rest = c >= 0.0 ? far : near;
    return start * rest * -fall / (start + rest * (1.0 + fall));
}

/* tanh(z / 2) to 2e-16 of 1, by one exponential: half the time of the library's, whose small values
 * are exact to the last digit. */
static double tanh_of_half(double z) { return 1.0 - 2.0 / (1.0 + exp(z)); }

/* What current and peak velocity alone tell of a loop. */
static generalized_loop generalized_at(const generalized_parameters *p, double i, double v_m)
{
    generalized_loop at;
    double rise = logistic_rise(p->a_3 * i, p->a_3 * p->I_1);
    at.C_i = fmax(1.0, 1.0 + p->k_2 * logistic_rise(p->a_2 * i, p->a_2 * p->I_0));
    at.F_t = p->F_0 * (1.0 + exp(p->a_1 * v_m));
    at.F_b = p->k_5 * at.C_i * at.F_t;
    at.a = p->a_0 / (1.0 + p->k_0 * v_m);
    at.v_h = p->k_4 * v_m * (1.0 + p->k_3 * rise);
    at.v_b = p->k_6 * v_m;
    at.decay = exp(-p->a_4 * v_m);
    return at;
}

static generalized_loop generalized_loop_of(const generalized_parameters *p, const motion *m)
{
    return generalized_at(p, m->i, m->v_m);
}

static double generalized_force(const generalized_parameters *p, const generalized_loop *at,
                                const motion *m)
{
    double bent = at->F_t * tanh_of_half(at->a * (m->v + m->side * at->v_h + at->v_b)) - at->F_b;
    double k_v = (m->v >= 0.0 ? p->k_1c : p->k_1e) * at->decay;
    return at->C_i * bent * (1.0 + k_v * fabs(m->v));
}

typedef struct {
    generalized_loop driven, idle; /* at this current, at 0 A */
} generalized_loops;

static generalized_loops generalized_loops_of(const generalized_parameters *p, const motion *m)
{
    generalized_loops both = {generalized_at(p, m->i, m->v_m), generalized_at(p, 0.0, m->v_m)};
    return both;
}

/* Yield part F(i) - F(0 A), viscous part F(0 A). */
static parts generalized_parts(const generalized_parameters *p, const generalized_loops *at,
                               const motion *m)
{
    parts both;
    both.viscous = generalized_force(p, &at->idle, m);
    both.yielding = generalized_force(p, &at->driven, m) - both.viscous;
    return both;
}
