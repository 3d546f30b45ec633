/* F = k_b max(|x| - x_b, 0) sgn x: a stop at the ends of the stroke. */
static double bump_stop(const bump_stop_parameters *p, const motion *m)
{
    return p->k_b * fmax(fabs(m->x) - p->x_b, 0.0) * sign(m->x);
}
