/* F_yield <- F_yield (1 - eta_e |v|): eddy currents take from the field. */
static void eddy_loss(const eddy_loss_parameters *p, const motion *m, changes *c)
{
    c->yielding *= 1.0 - p->eta_e * fabs(m->v);
}
