/* F = F_s exp(-(v/v_st)^2) y, dy/dx = (sgn v - y) sigma_0 / F_s: what friction at rest has more. */
typedef bristle stribeck_friction_past;

static double stribeck_friction(const stribeck_friction_parameters *p, const motion *m,
                                const stribeck_friction_past *past, stribeck_friction_past *next)
{
    double speed = m->v / p->v_st;
    return p->F_s * exp(-speed * speed) * bent(p->F_s / p->sigma_0, m, past, next);
}
