/* One damper: its parameters, its past, and what estimates derivatives needs. */
typedef struct {
    parameters p;
    whole_past past[2]; /* one is the past, the other what follows from it */
    lines memory;
    int now;            /* which of them is the past */
    int samples;        /* so far, up to 2 */
    double t[2], x[2], v[2]; /* of the last two samples, the newest first */
    double force, side; /* the last ones */
    int outside;        /* in what the last sample left the conditions of the card */
} instance;

/* First and second derivative at the newest of three samples, of the parabola through them. */
static void backward(const instance *d, double t, double z, const double *old, double *first,
                     double *second)
{
    double slope, before, bend;
    *first = *second = 0.0;
    if (d->samples < 1)
        return;
    slope = (z - old[0]) / (t - d->t[0]);
    *first = slope;
    if (d->samples < 2)
        return;
    before = (old[0] - old[1]) / (d->t[0] - d->t[1]);
    bend = (slope - before) / (t - d->t[1]);
    *first = slope + bend * (t - d->t[0]);
    *second = 2.0 * bend;
}

static int is_number(double z) { return z - z == 0.0; }

enum { TAKEN = 0, REFUSED = 1, NOT_SOLVED = 2, DELAY_TOO_LONG = 3, OUTSIDE = 4 };

/* The motion that a sample describes; 0 where the sample is not one. */
static int described(const instance *d, double t, double x, double v, double a, double i, double T,
                     motion *m)
{
    double first, second;
    if (!is_number(t) || !is_number(x) || !is_number(i) || (!is_number(v) && v == v) ||
        (!is_number(a) && a == a) || (!is_number(T) && T == T))
        return 0;
    if (d->samples > 0 && !(t > d->t[0]))
        return 0;
    if (v != v) {
        backward(d, t, x, d->x, &first, &second);
        v = first;
        if (a != a)
            a = second;
    } else if (a != a) {
        backward(d, t, v, d->v, &a, &second);
    }
    m->first = d->samples == 0;
    m->t = t;
    m->h = m->first ? 0.0 : t - d->t[0];
    m->x = x;
    m->v = v;
    m->a = a;
    m->side = sign(a);
    m->v_m = sqrt(fmax(v * v - a * x, 0.0));
    m->i = i;
    m->T = T;
    m->stride = m->first ? 0.0 : x - d->x[0];
    return 1;
}

/* The force of a motion that may still be tried with other numbers. */
static double tried(instance *d, const motion *m, int *code)
{
    int solved = 1, short_line = 0;
    double force = recorded_force(&d->p, &d->memory, m, &d->past[d->now], &d->past[1 - d->now],
                                  &solved, &short_line);
    *code = !solved || !is_number(force) ? NOT_SOLVED : short_line ? DELAY_TOO_LONG : TAKEN;
    return force;
}

/* What follows from the motion that was tried last becomes the past; the code that is told. */
static int accept(instance *d, const motion *m, double force, int code)
{
    d->now = 1 - d->now;
    d->t[1] = d->t[0];
    d->x[1] = d->x[0];
    d->v[1] = d->v[0];
    d->t[0] = m->t;
    d->x[0] = m->x;
    d->v[0] = m->v;
    d->side = m->side;
    if (d->samples < 2)
        d->samples++;
    if (is_number(force))
        d->force = force;
    d->outside = beyond(m->x, m->v, m->i, m->T);
    return code == TAKEN && d->outside ? OUTSIDE : code;
}

/* Take one sample: velocity and acceleration may be NAN, and are then estimated from the past; the
 * temperature may be NAN where it is not known.  A sample that is refused changes nothing. */
static int take(instance *d, double t, double x, double v, double a, double i, double T,
                double *force)
{
    motion m;
    int code = REFUSED;
    if (described(d, t, x, v, a, i, T, &m)) {
        double found = tried(d, &m, &code);
        code = accept(d, &m, found, code);
    }
    *force = d->force;
    return code;
}
$PLANT$
static void forget(instance *d)
{
    d->samples = d->outside = 0;
    d->force = d->side = 0.0;
}
