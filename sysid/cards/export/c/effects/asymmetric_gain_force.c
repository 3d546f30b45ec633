/* F_rec = F + g_a |F|. */
static double asymmetric_gain_force(const asymmetric_gain_force_parameters *p, double force, const motion *m)
{
    (void)m;
    return force + p->g_a * fabs(force);
}
