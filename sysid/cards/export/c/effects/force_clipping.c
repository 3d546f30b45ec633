/* F_rec = F / max(1, q_F |F|): the range of the force channel ends at 1 / q_F. */
static double force_clipping(const force_clipping_parameters *p, double force, const motion *m)
{
    (void)m;
    return force / fmax(1.0, p->q_F * fabs(force));
}
