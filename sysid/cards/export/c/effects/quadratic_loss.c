/* F = c_2 v |v|: entrance and turbulent loss. */
static double quadratic_loss(const quadratic_loss_parameters *p, const motion *m)
{
    return p->c_2 * m->v * fabs(m->v);
}
