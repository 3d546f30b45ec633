
/* A mass that the damper holds: mass * a + F(a) = rest, rest the other forces on it.
 *
 * F jumps with the sign of a.  Where both signs agree with themselves the last one stays, as on a
 * loop; where the force is too small for the one sign and too large for the other, the mass moves at
 * a constant speed and the damper carries `rest`.  A peak speed that follows from the acceleration
 * may make the force of a light mass grow without end: then there is no solution. */
typedef struct {
    instance *d;
    motion m;
    double mass, rest;
    int code;
} held_mass;

static double unbalanced(double a, void *about)
{
    held_mass *s = about;
    s->m.a = a;
    s->m.v_m = sqrt(fmax(s->m.v * s->m.v - a * s->m.x, 0.0));
    return a + (tried(s->d, &s->m, &s->code) - s->rest) / s->mass;
}

static int take_in_plant(instance *d, double t, double x, double v, double i, double T, double mass,
                         double rest, double *a, double *force)
{
    held_mass s;
    double slope = 1.0, start, side = d->side != 0.0 ? d->side : 1.0, guess, above, below;
    int k, found;
    *force = d->force;
    *a = 0.0;
    if (!is_number(rest) || !(mass > 0.0) || !described(d, t, x, v, 0.0, i, T, &s.m) || v != v)
        return REFUSED;
    s.d = d;
    s.mass = mass;
    s.rest = rest;
    start = (rest - d->force) / mass;
    for (k = 0; k < 2; k++, side = -side) {
        s.m.side = side;
        guess = root_of(unbalanced, &s, start, &slope, 1.0e-12 * fabs(start) + 1.0e-12, &found);
        if (found && guess * side > 0.0) {
            unbalanced(guess, &s);
            *a = guess;
            *force = rest - mass * guess;
            return accept(d, &s.m, *force, s.code);
        }
    }
    s.m.side = 1.0;
    above = unbalanced(0.0, &s);
    s.m.side = -1.0;
    below = unbalanced(0.0, &s);
    s.m.side = 0.0;
    unbalanced(0.0, &s);
    *force = above >= 0.0 && below <= 0.0 ? rest : d->force;
    return accept(d, &s.m, *force, above >= 0.0 && below <= 0.0 ? s.code : NOT_SOLVED);
}
