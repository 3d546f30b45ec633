/* F = F_g (1 / (1 + x/l_g) - 1) sgn_s(v): guides that are pressed the harder the nearer they are. */
static double guide_friction(const guide_friction_parameters *p, const motion *m)
{
    double share = fmax(1.0 + m->x / fmax(p->l_g, 1.0e-9), 0.05);
    return p->F_g * (1.0 / share - 1.0) * smooth_sign(m->v);
}
