/* F = c v + k_0 x + f_0 + alpha w,   dw/dx = rho (1 - w sgn dx),
 *     c and alpha = value at 0 A + rise s(i),  s(i) = (1 - e^{-q |i|}) / q */
typedef struct {
    double w;
} dahl_past;

static parts dahl_parts(const dahl_parameters *p, const motion *m, const dahl_past *past,
                        dahl_past *next)
{
    double s = effective_current(m->i, p->q);
    double ahead = m->stride >= 0.0 ? 1.0 : -1.0;
    parts both;
    next->w = m->first ? 0.0 : past->w - (ahead - past->w) * expm1(-p->rho * fabs(m->stride));
    both.viscous = p->c_a * m->v + p->k_0 * m->x + p->f_0 + p->alpha_a * next->w;
    both.yielding = p->c_b * s * m->v + p->alpha_b * s * next->w;
    return both;
}
