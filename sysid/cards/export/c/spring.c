/* A spring of compliance s in series with everything behind it, which is at
 *     x - s F,   v - s F',   a - s F'',   F = force there,
 * derivatives by the newest three samples.  The place is that of a first solution in which it is
 * x itself. */
typedef struct {
    double offset;        /* m, place less x, at the last sample */
    double force, before; /* N, at the last sample and the one before */
    double slope;         /* of the spring's equation at its last root */
    $BEHIND$_past behind;
} $MEMBER$_solution;

typedef struct {
    double h;
    $MEMBER$_solution solution[2];
} through_$MEMBER$_past;

typedef struct {
    const parameters *p;
    lines *memory;
    const motion *m;
    double x, d[3], e[3]; /* m; 1/s and 1/s2, difference formulas */
    const $MEMBER$_solution *past;
    $MEMBER$_solution *next;
    int *solved;
    double carried; /* N, behind the spring where it was tried last */
} $MEMBER$_search;

static double $MEMBER$_behind(const $MEMBER$_search *s, double force)
{
    motion moved = *s->m;
    const $MEMBER$_solution *past = s->past;
    double s_k = s->p->$MEMBER$.s_k;
    moved.x = s->x;
    moved.stride += s->m->first ? 0.0 : (s->x - s->m->x) - past->offset;
    moved.v -= s_k * (s->d[0] * force + s->d[1] * past->force + s->d[2] * past->before);
    moved.a -= s_k * (s->e[0] * force + s->e[1] * past->force + s->e[2] * past->before);
    return $BEHIND$(s->p, $LINES$&moved, &past->behind, &s->next->behind, s->solved);
}

static double $MEMBER$_excess(double force, void *about)
{
    $MEMBER$_search *s = about;
    s->carried = $MEMBER$_behind(s, force);
    return force - s->carried;
}

static double through_$MEMBER$(const parameters *p, lines *memory, const motion *m,
                               const through_$MEMBER$_past *past, through_$MEMBER$_past *next,
                               int *solved)
{
    $MEMBER$_search s = {p,    memory, m,      m->x, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0},
                         NULL, NULL,   solved, 0.0};
    double h = m->h, older = past->h, force = 0.0;
    int k, found;
    next->h = h;
    if (!m->first && older > 0.0) {
        double r = h / older;
        s.d[0] = (1.0 + 2.0 * r) / (1.0 + r) / h;
        s.d[1] = -(1.0 + r) / h;
        s.d[2] = r * r / (1.0 + r) / h;
        s.e[0] = 2.0 / (h * (h + older));
        s.e[1] = -2.0 / (h * older);
        s.e[2] = 2.0 / (older * (h + older));
    } else if (!m->first) {
        s.d[0] = 1.0 / h;
        s.d[1] = -1.0 / h;
    }
    for (k = 0; k < 2; k++) {
        $MEMBER$_solution *now = &next->solution[k];
        s.past = &past->solution[k];
        s.next = now;
        now->slope = m->first ? 1.0 : k ? next->solution[0].slope : s.past->slope;
        if (m->first) {
            force = $MEMBER$_behind(&s, 0.0);
        } else {
            /* straight on, the second beside the first as far as it was */
            double start = 2.0 * s.past->force - s.past->before;
            double smallest = 1.0e-11 * fabs(s.past->force) + 1.0e-9;
            if (k)
                start += force - (2.0 * past->solution[0].force - past->solution[0].before);
            root_of($MEMBER$_excess, &s, start, &now->slope, smallest, &found);
            *solved = *solved && found;
            force = s.carried;
        }
        now->offset = s.x - m->x;
        now->before = m->first ? force : s.past->force;
        now->force = force;
        s.x = m->x - p->$MEMBER$.s_k * force;
    }
    return force;
}
