/* A bi-viscous element and a mass behind a spring, all of them warm; x is the piston, y the element:
 *
 *     F = k (x - y),    m_l y'' = k (x - y) - chi(y')
 *     chi(w) = C_pre w for |w| <= v_y, else F_y sgn w + C_post w,   v_y = F_y / (C_pre - C_post)
 *     C_post, F_y (tables over current, straight between) and k = intercept + slope T
 *     tau i_eff' = i - i_eff
 *
 * Between two samples the piston moves by the cubic through both places and velocities, and the
 * element has the mean of its numbers at both ends; on each branch of chi the solution is a parabola
 * and two exponentials, and every switch between branches is located in time. */
typedef struct {
    double stiffness, mass, pre, post, yielding; /* k, m_l, C_pre, C_post, F_y */
    double leakage;                              /* m/(s N), beside element and spring */
} element;

typedef struct {
    double u, w; /* m, compression of the spring; m/s, velocity of the element */
} element_state;

typedef struct {
    double v;
    lag current;
    element numbers;
    element_state state;
} lumped_past;

/* One step: its length, velocity of the piston v_0 + v_1 t + v_2 t^2, and the element. */
typedef struct {
    double h, v_0, v_1, v_2;
    element e;
} step_of_element;

/* On one branch, from a time within the step on. */
typedef struct {
    const step_of_element *step;
    double branch, since;
    double c, k, m, relief;                /* of the linear equation */
    double alpha, mean, kappa;             /* of its exponentials, 1/s, 1/s, 1/s2 */
    double p_0, p_1, p_2, q_0, q_1, q_2;   /* of its parabolas in u and w */
} way;

static double yield_velocity(const element *e) { return e->yielding / (e->pre - e->post); }

static way way_of(const step_of_element *step, double branch, double since)
{
    const element *e = &step->e;
    way y;
    double v_1 = step->v_1 + 2.0 * step->v_2 * since;
    double v_0 = step->v_0 + (step->v_1 + step->v_2 * since) * since;
    double slack, inertia, passed, held;
    y.step = step;
    y.branch = branch;
    y.since = since;
    y.c = branch == 0.0 ? e->pre : e->post;
    y.k = e->stiffness;
    y.m = e->mass;
    y.relief = e->leakage * e->stiffness;
    y.alpha = 0.5 * (y.c / y.m - y.relief);
    y.mean = 0.5 * (y.c / y.m + y.relief);
    y.kappa = y.k / y.m;
    slack = y.c / y.k;
    inertia = y.m / y.k;
    passed = 1.0 + y.relief * slack;
    y.q_2 = step->v_2 / passed;
    y.q_1 = (v_1 - 2.0 * (slack + y.relief * inertia) * y.q_2) / passed;
    y.p_1 = 2.0 * inertia * y.q_2 + slack * y.q_1;
    y.p_2 = slack * y.q_2;
    held = branch * e->yielding / y.k + inertia * y.q_1;
    y.q_0 = (v_0 - y.p_1 - y.relief * held) / passed;
    y.p_0 = held + slack * y.q_0;
    return y;
}

/* e^{-mean t} cosh(d t) and e^{-mean t} sinh(d t) / d with d^2 = alpha^2 - kappa of either sign. */
static void decays(const way *y, double t, double *even, double *odd)
{
    double square = y->alpha * y->alpha - y->kappa, x = square * t * t;
    double size, slow, decay;
    if (fabs(x) < 1.0e-3) {
        slow = y->mean;
        *even = 1.0 + x * (1.0 / 2 + x * (1.0 / 24 + x / 720));
        *odd = t * (1.0 + x * (1.0 / 6 + x * (1.0 / 120 + x / 5040)));
    } else if (square > 0.0) {
        double fast;
        size = sqrt(square);
        slow = ((y->mean - y->alpha) * (y->mean + y->alpha) + y->kappa) / (y->mean + size);
        fast = exp(-2.0 * size * t);
        *even = 0.5 * (1.0 + fast);
        *odd = 0.5 * (1.0 - fast) / size;
    } else {
        size = sqrt(-square);
        slow = y->mean;
        *even = cos(size * t);
        *odd = sin(size * t) / size;
    }
    decay = exp(-slow * t);
    *even *= decay;
    *odd *= decay;
}

static element_state along(const way *y, element_state z, double t)
{
    double even, odd, u = z.u - y->p_0, w = z.w - y->q_0;
    element_state end;
    decays(y, t, &even, &odd);
    end.u = y->p_0 + (y->p_1 + y->p_2 * t) * t + (even + y->alpha * odd) * u - odd * w;
    end.w = y->q_0 + (y->q_1 + y->q_2 * t) * t + y->kappa * odd * u + (even - y->alpha * odd) * w;
    return end;
}

/* The branch on which a state belongs that has come along a branch. */
static double following(const way *y, element_state z)
{
    double limit = yield_velocity(&y->step->e);
    if (y->branch == 0.0)
        return fabs(z.w) > limit ? sign(z.w) : 0.0;
    return y->branch * z.w < limit ? 0.0 : y->branch;
}

/* After yield: can ringing bring the element below v_y and back in the time left? */
static int may_dip(const way *y, element_state z, double left)
{
    double square = y->kappa - y->alpha * y->alpha, omega, u, w, size, slowest, rate;
    if (square <= 0.0)
        return 0;
    omega = sqrt(square);
    u = z.u - y->p_0;
    w = z.w - y->q_0;
    size = hypot(w, (y->kappa * u - y->alpha * w) / omega);
    slowest = fmin(y->branch * y->q_0, y->branch * (y->q_0 + (y->q_1 + y->q_2 * left) * left));
    rate = fmin(fabs(y->q_1), fabs(y->q_1 + 2.0 * y->q_2 * left));
    return slowest - size < yield_velocity(&y->step->e) && omega * size > rate;
}

/* Before yield: can the spring be loaded up to F_y and relieved in the time left? */
static int may_peak(const way *y, element_state z, element_state end, double left)
{
    const element *e = &y->step->e;
    double v_1 = y->step->v_1 + 2.0 * y->step->v_2 * y->since;
    double v_0 = y->step->v_0 + (y->step->v_1 + y->step->v_2 * y->since) * y->since;
    double creep = e->stiffness / e->pre + y->relief;
    double begins = v_0 - creep * z.u;
    double ends = v_0 + (v_1 + y->step->v_2 * left) * left - creep * end.u;
    double reach = fmax(fabs(z.u), fabs(end.u)) + fmin(fabs(begins), fabs(ends)) * left;
    return following(y, end) == 0.0 && begins * ends < 0.0 && e->stiffness * reach > e->yielding;
}

enum { BRANCHES = 8, PROBES = 16, TRIALS = 60 };

/* When the branch is left: its time, at most `left`; `leaves` tells whether it is. */
static double exit_of(const way *y, element_state z, double left, int *leaves, double *next_branch)
{
    element_state end = along(y, z, left);
    double high = left, side = following(y, end), low, t, outward, limit;
    int hidden, k, trial;
    hidden = y->branch == 0.0 ? may_peak(y, z, end, left) : may_dip(y, z, left);
    for (k = 1; hidden && k < PROBES; k++) {
        double probe = left * k / PROBES;
        double there = following(y, along(y, z, probe));
        if (there != y->branch) {
            high = probe;
            side = there;
            break;
        }
    }
    *next_branch = side;
    *leaves = side != y->branch;
    if (!*leaves)
        return left;
    if (y->branch != 0.0)
        outward = -y->branch, limit = y->branch * yield_velocity(&y->step->e);
    else
        outward = side, limit = side * yield_velocity(&y->step->e);
    low = 0.0;
    t = high;
    for (trial = 0; trial < TRIALS; trial++) {
        element_state here = along(y, z, t);
        double beyond = outward * (here.w - limit), rate, better;
        rate = y->k * here.u - y->c * here.w - y->branch * y->step->e.yielding;
        rate *= outward / y->m;
        if (beyond > 0.0)
            high = t;
        else
            low = t;
        better = rate == 0.0 ? t - beyond : t - beyond / rate;
        if (!(better > low && better < high))
            better = 0.5 * (low + high);
        if (fabs(better - t) <= 1.0e-8 * y->step->h) {
            t = better;
            break;
        }
        t = better;
    }
    return t;
}

static element_state follow_element(const step_of_element *step, element_state z)
{
    double limit = yield_velocity(&step->e);
    double branch = fabs(z.w) >= limit ? sign(z.w) : 0.0, left = step->h;
    int taken;
    for (taken = 0; taken < BRANCHES && left > 0.0; taken++) {
        way y = way_of(step, branch, step->h - left);
        int leaves;
        double next_branch, t = exit_of(&y, z, left, &leaves, &next_branch);
        if (taken == BRANCHES - 1 || !leaves) {
            z = along(&y, z, left);
            left = 0.0;
        } else {
            z = along(&y, z, t);
            left -= t;
            branch = next_branch;
        }
    }
    return z;
}

/* A table over current: straight lines, of which the first and the last go on. */
static double read_table(const double *currents, const double *values, int count, double current)
{
    double i = fabs(current), share;
    int k = 0;
    if (count == 1)
        return values[0];
    while (k < count - 2 && i >= currents[k + 1])
        k++;
    share = (i - currents[k]) / (currents[k + 1] - currents[k]);
    return values[k] + share * (values[k + 1] - values[k]);
}

static element element_of(const lumped_parameters *p, const motion *m, double current,
                          const changes *c)
{
    double T = 40.0 + excess_temperature(m);
    double post = read_table(p->currents, p->C_post_intercept, LUMPED_CURRENTS, current) +
                  read_table(p->currents, p->C_post_slope, LUMPED_CURRENTS, current) * T;
    double yielding = read_table(p->currents, p->F_y_intercept, LUMPED_CURRENTS, current) +
                      read_table(p->currents, p->F_y_slope, LUMPED_CURRENTS, current) * T;
    element e;
    e.stiffness = fmax(p->k_intercept + p->k_slope * T, 1.0e4) * c->stiffness;
    e.stiffness /= 1.0 + c->compliance * e.stiffness;
    e.mass = p->m_l;
    e.pre = p->C_pre;
    e.post = clip(clip(post, 1.0e-3, 0.9 * p->C_pre) * c->viscous, 1.0e-3, 0.9 * p->C_pre);
    e.yielding = fmax(fmax(yielding, 1.0e-6) * c->yielding, 1.0e-6);
    e.leakage = c->leakage;
    return e;
}

static element mean_element(const element *a, const element *b)
{
    element e;
    e.stiffness = 0.5 * (a->stiffness + b->stiffness);
    e.mass = 0.5 * (a->mass + b->mass);
    e.pre = 0.5 * (a->pre + b->pre);
    e.post = 0.5 * (a->post + b->post);
    e.yielding = 0.5 * (a->yielding + b->yielding);
    e.leakage = 0.5 * (a->leakage + b->leakage);
    return e;
}

/* Yield part (C_pre - C_post) clip(w, -v_y, v_y), viscous part what is left of k u. */
static parts lumped_parts(const lumped_parameters *p, const motion *m, const changes *c,
                          const lumped_past *past, lumped_past *next)
{
    double current = lagged(p->tau, m->i, m, &past->current, &next->current);
    double limit;
    parts both;
    next->v = m->v;
    next->numbers = element_of(p, m, current, c);
    if (m->first) {
        next->state.u = next->state.w = 0.0;
    } else {
        step_of_element step;
        double bend = 3.0 * (past->v + m->v) - 6.0 * m->stride / m->h;
        step.h = m->h;
        step.v_0 = past->v;
        step.v_1 = (m->v - past->v - bend) / m->h;
        step.v_2 = bend / (m->h * m->h);
        step.e = mean_element(&past->numbers, &next->numbers);
        next->state = follow_element(&step, past->state);
    }
    limit = yield_velocity(&next->numbers);
    both.yielding =
        (next->numbers.pre - next->numbers.post) * clip(next->state.w, -limit, limit);
    both.viscous = next->numbers.stiffness * next->state.u - both.yielding;
    return both;
}
