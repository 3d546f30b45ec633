/* A loose pin: contact ends where the force does not pull with the motion any more, and from there
 * the rod goes delta and carries nothing. */
typedef struct {
    play pin;
    double x, force;
} backlash_loose_past;

static double backlash_loose(const backlash_loose_parameters *p, double force, const motion *m,
                             const backlash_loose_past *past, backlash_loose_past *next)
{
    double direction = m->first ? 0.0 : sign(m->x - past->x);
    double after = direction * force, before = m->first ? 0.0 : direction * past->force;
    double turn = after * before < 0.0 ? before / (before - after) : before;
    double begin = before >= 0.0 ? 0.0 : after * before < 0.0 ? turn : 1.0;
    double end = after >= 0.0 ? 1.0 : after * before < 0.0 ? turn : begin;
    stretch_of_travel step = travelled(p->delta, begin, end, m, &past->pin, &next->pin);
    next->x = m->x;
    next->force = force;
    return force * mean_engaged(p->delta, &step);
}
