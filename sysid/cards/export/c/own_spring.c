/* What a spring takes from a motion when it carries a force: -s F, -s F', -s F'', derivatives by the
 * newest three samples. */
typedef struct {
    double h, force, before;
} carried;

static motion behind_spring(double s_k, double force, const motion *m, const carried *past,
                            carried *next)
{
    motion moved = *m;
    double h = m->h, rate = 0.0, bend = 0.0;
    if (!m->first && past->h > 0.0) {
        double r = h / past->h;
        rate = ((1.0 + 2.0 * r) / (1.0 + r) * force - (1.0 + r) * past->force +
                r * r / (1.0 + r) * past->before) /
               h;
        bend = 2.0 * force / (h * (h + past->h)) - 2.0 * past->force / (h * past->h) +
               2.0 * past->before / (past->h * (h + past->h));
    } else if (!m->first) {
        rate = (force - past->force) / h;
    }
    moved.x -= s_k * force;
    moved.v -= s_k * rate;
    moved.a -= s_k * bend;
    moved.stride -= m->first ? 0.0 : s_k * (force - past->force);
    next->h = h;
    next->before = m->first ? force : past->force;
    next->force = force;
    return moved;
}
