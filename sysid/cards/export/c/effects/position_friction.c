/* F = c_xf x sgn_s(v): friction that changes along the stroke. */
static double position_friction(const position_friction_parameters *p, const motion *m)
{
    return p->c_xf * m->x * smooth_sign(m->v);
}
