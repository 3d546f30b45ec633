/* An element with hysteresis in series with a dashpot, a leak and a spring; u is its travel, w its
 * state, x the piston:
 *
 *     F = F' + k_1 x_v + f_0,   F' = alpha w + c_0 u' + k_0 u,   x_v = x - s F,
 *     u' = x_v' - F' (1 / c_1 + leakage)
 *
 * A step solves one scalar equation for the change of u, with w at its end by its exact flow; the
 * weight of the end grows from 1/2 to 1 as the step becomes stiff.  The derivative of F' is that of
 * its newest three samples. */
typedef struct {
    double yielding[2], inner[2]; /* alpha and c_0: at 0 A, and what the field adds */
    double mobility, stiffness, rho;
    double sigma;                 /* negative where the state is Dahl's */
    double beside, constant;      /* k_1, f_0 */
    double compliance;
} series_law;

typedef struct {
    double h, v, u, w, rate, carried, before;
} series_past;

static double series_flow(const series_law *l, double w, double run)
{
    double ahead = run >= 0.0 ? 1.0 : -1.0;
    if (l->sigma < 0.0)
        return w - (ahead - w) * expm1(-l->rho * fabs(run));
    return bouc_wen_flow(l->rho, l->sigma, w, run);
}

static double series_rate(const series_law *l, double run, double w)
{
    double y = (run >= 0.0 ? 1.0 : -1.0) * w;
    if (l->sigma < 0.0)
        return l->rho * (1.0 - y);
    return l->rho * (1.0 + (y < 0.0 ? 2.0 * l->sigma - 1.0 : -1.0) * y * y);
}

static double series_mean_rate(const series_law *l, double w)
{
    return l->sigma < 0.0 ? l->rho : l->rho * (1.0 + (l->sigma - 1.0) * w * w);
}

/* Change of u in a step: inert run + share w(run) = known. */
static double series_run(const series_law *l, double w, double known, double inert, double share)
{
    double low = (known - share) / inert, high = (known + share) / inert;
    double push = known - share * w, run;
    int trial;
    if (share == 0.0)
        return known / inert;
    run = clip(push / (inert + share * series_rate(l, push, w)), low, high);
    for (trial = 0; trial < 9; trial++) {
        double there = series_flow(l, w, run);
        double over = inert * run + share * there - known;
        double better = run - over / (inert + share * series_rate(l, run, there));
        if (trial == 8)
            return better;
        if (over < 0.0)
            low = run;
        if (over > 0.0)
            high = run;
        run = better >= low && better <= high ? better : 0.5 * (low + high);
    }
    return run;
}

static void series_advance(const series_law *l, const motion *m, double follows,
                           const series_past *past, series_past *next)
{
    double s = follows * l->compliance, h = m->h;
    double alpha = l->yielding[0] + l->yielding[1], inner = l->inner[0] + l->inner[1];
    double mu = l->mobility, pull = 0.0, v_0 = past->v * h, drive, travel = follows * m->stride;
    double whole, nu, stiff, late, known, run;
    next->v = follows * m->v;
    if (past->h > 0.0) {
        double r = h / past->h;
        mu += s * (1.0 + 2.0 * r) / (1.0 + r) / h;
        pull = s * (r * r * past->before / (1.0 + r) - (1.0 + r) * past->carried) / h;
    } else {
        mu += s / h;
        pull = -s * past->carried / h;
    }
    whole = 1.0 + inner * mu;
    nu = mu / whole;
    stiff = h * alpha * series_mean_rate(l, past->w) * nu;
    late = 0.5 + 0.5 * stiff / (stiff + 6.0);
    drive = (next->v - pull) * h;
    known = (1.0 - late) * h * past->rate +
            (late * drive + travel - 0.5 * (v_0 + next->v * h)) / whole -
            late * h * nu * l->stiffness * past->u;
    run = series_run(l, past->w, known, 1.0 + late * h * nu * l->stiffness, late * h * nu * alpha);
    next->u = past->u + run;
    next->w = series_flow(l, past->w, run);
    next->rate = (drive / h - mu * (alpha * next->w + l->stiffness * next->u)) / whole;
    next->before = past->carried;
}

/* The parts of the force, N: that of the field is what it adds to alpha w + c_0 u'. */
static parts series_parts(const series_law *l, const motion *m, const series_past *past,
                          series_past *next)
{
    double follows = 1.0 / (1.0 + l->compliance * l->beside);
    double gas = l->beside * m->x + l->constant;
    parts both;
    if (m->first) {
        next->v = follows * m->v;
        next->u = next->w = 0.0;
        next->rate = next->v / (1.0 + (l->inner[0] + l->inner[1]) * l->mobility);
    } else {
        series_advance(l, m, follows, past, next);
    }
    next->h = m->h;
    both.yielding = l->yielding[1] * next->w + l->inner[1] * next->rate;
    both.viscous = l->yielding[0] * next->w + l->inner[0] * next->rate + l->stiffness * next->u;
    next->carried = both.yielding + both.viscous;
    if (m->first)
        next->before = next->carried;
    both.viscous +=
        gas - l->compliance * l->beside * follows * (next->carried + gas);
    return both;
}
