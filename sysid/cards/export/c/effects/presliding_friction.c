/* dF/dx = sigma_0 (1 - F sgn(v) / F_ps): friction that builds up over a short travel. */
typedef bristle presliding_friction_past;

static double presliding_friction(const presliding_friction_parameters *p, const motion *m,
                                  const presliding_friction_past *past,
                                  presliding_friction_past *next)
{
    return p->F_ps * bent(p->F_ps / p->sigma_0, m, past, next);
}
