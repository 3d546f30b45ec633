/* Bouc-Wen, a dashpot and a spring, in series with a second dashpot; u is their travel, w the state:
 *
 *     F = c_1 (v - u') + k_1 x + f_0,   (c_0 + c_1) u' = c_1 v - alpha w - k_0 u
 *     dw/du as in the Bouc-Wen model,
 *     alpha, c_0 and c_1 = value at 0 A + rise s(i),  s(i) = (1 - e^{-q |i|}) / q
 *
 * A step solves one scalar equation for the change of u, with w at its end by its exact flow; the
 * weight of the end grows from 1/2 to 1 as the step becomes stiff. */
typedef struct {
    double u, w;
} series_state;

typedef struct {
    double v;
    series_state field, idle; /* at the current, and at 0 A */
} modified_bouc_wen_past;

static double series_rate(const modified_bouc_wen_parameters *p, double run, double w)
{
    double y = (run >= 0.0 ? 1.0 : -1.0) * w;
    return p->rho * (1.0 + (y < 0.0 ? 2.0 * p->sigma - 1.0 : -1.0) * y * y);
}

static series_state advanced(const modified_bouc_wen_parameters *p, const motion *m, double v_0,
                                double alpha, double inner, double outer, series_state past)
{
    double viscosity = inner + outer, h = m->h;
    double push = outer * m->stride - h * (p->k_0 * past.u + alpha * past.w);
    double stiff = h * alpha * p->rho * (1.0 + (p->sigma - 1.0) * past.w * past.w) / viscosity;
    double late = 0.5 + 0.5 * stiff / (stiff + 6.0);
    double inert = viscosity + h * late * p->k_0;
    double known =
        push + h * late * alpha * past.w + (late - 0.5) * outer * (m->v * h - v_0 * h);
    double share = h * late * alpha;
    double low = (known - share) / inert, high = (known + share) / inert, run;
    int trial;
    series_state next;
    run = clip(push / (inert + share * series_rate(p, push, past.w)), low, high);
    for (trial = 0; trial < 9; trial++) {
        double w = bouc_wen_flow(p->rho, p->sigma, past.w, run);
        double over = inert * run + share * w - known, better;
        better = run - over / (inert + share * series_rate(p, run, w));
        if (trial == 8) {
            run = better;
            break;
        }
        if (over < 0.0)
            low = run;
        if (over > 0.0)
            high = run;
        run = better >= low && better <= high ? better : 0.5 * (low + high);
    }
    next.u = past.u + run;
    next.w = bouc_wen_flow(p->rho, p->sigma, past.w, run);
    return next;
}

static double series_force(const modified_bouc_wen_parameters *p, const motion *m, double i,
                           double v_0, series_state past, series_state *next)
{
    double s = effective_current(i, p->q);
    double alpha = p->alpha_a + p->alpha_b * s;
    double inner = p->c_0a + p->c_0b * s, outer = p->c_1a + p->c_1b * s;
    if (m->first)
        next->u = next->w = 0.0;
    else
        *next = advanced(p, m, v_0, alpha, inner, outer, past);
    return outer * (alpha * next->w + p->k_0 * next->u + inner * m->v) / (inner + outer) +
           p->k_1 * m->x + p->f_0;
}

static parts modified_bouc_wen_parts(const modified_bouc_wen_parameters *p, const motion *m,
                                     const modified_bouc_wen_past *past,
                                     modified_bouc_wen_past *next)
{
    parts both;
    next->v = m->v;
    both.viscous = series_force(p, m, 0.0, past->v, past->idle, &next->idle);
    both.yielding =
        series_force(p, m, m->i, past->v, past->field, &next->field) - both.viscous;
    return both;
}
