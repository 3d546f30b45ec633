/* F_rec = F (1 + g_a sgn_s(v)). */
static double asymmetric_gain_velocity(const asymmetric_gain_velocity_parameters *p, double force, const motion *m)
{
    return force * (1.0 + p->g_a * smooth_sign(m->v));
}
