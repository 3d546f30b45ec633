/* F = F_c sgn_s(v): Coulomb friction of the seal. */
static double seal_friction(const seal_friction_parameters *p, const motion *m)
{
    return p->F_c * smooth_sign(m->v);
}
