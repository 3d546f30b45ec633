/* F = c v + k_0 x + f_0 + alpha w,
 *     dw/dx = rho (1 - sigma sgn(dx) |w| w - (1 - sigma) w^2),
 *     c and alpha = value at 0 A + rise s(i),  s(i) = (1 - e^{-q |i|}) / q */
typedef struct {
    double w;
} bouc_wen_past;

static parts bouc_wen_parts(const bouc_wen_parameters *p, const motion *m,
                            const bouc_wen_past *past, bouc_wen_past *next)
{
    double s = effective_current(m->i, p->q);
    parts both;
    next->w = m->first ? 0.0 : bouc_wen_flow(p->rho, p->sigma, past->w, m->stride);
    both.viscous = p->c_a * m->v + p->k_0 * m->x + p->f_0 + p->alpha_a * next->w;
    both.yielding = p->c_b * s * m->v + p->alpha_b * s * next->w;
    return both;
}
