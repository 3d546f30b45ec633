/* F = c v + k_0 x + f_0 + alpha w,
 *     dw/dx = rho (1 - sigma sgn(dx) |w| w - (1 - sigma) w^2),
 *     c and alpha = value at 0 A + rise s(i),  s(i) = (1 - e^{-q |i|}) / q,
 * with v and x of what a leak and a spring leave. */
typedef struct {
    series_past series;
} bouc_wen_past;

static parts bouc_wen_parts(const bouc_wen_parameters *p, const motion *m, const changes *c,
                            const bouc_wen_past *past, bouc_wen_past *next)
{
    double s = effective_current(m->i, p->q);
    series_law l;
    l.yielding[0] = p->alpha_a * c->viscous;
    l.yielding[1] = p->alpha_b * s * c->yielding;
    l.inner[0] = p->c_a * c->viscous;
    l.inner[1] = p->c_b * s * c->yielding;
    l.mobility = c->leakage;
    l.stiffness = 0.0;
    l.rho = p->rho * c->stiffness;
    l.sigma = p->sigma;
    l.beside = p->k_0;
    l.constant = p->f_0;
    l.compliance = c->compliance;
    return series_parts(&l, m, &past->series, &next->series);
}
